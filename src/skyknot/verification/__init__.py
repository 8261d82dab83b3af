"""IS IT TRUE: an independent certificate. Imports no solver, no transcription, no kernel."""
