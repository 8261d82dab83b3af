"""The command line: thin, and kind to people."""
