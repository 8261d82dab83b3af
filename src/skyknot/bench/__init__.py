"""HOW fast, how reliable: skyknot against its peers, in one process, on the same programs."""
