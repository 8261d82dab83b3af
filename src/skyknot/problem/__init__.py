"""WHAT is asked, in continuous time: costs, constraints, horizon, ends, guess. No mesh in here."""
