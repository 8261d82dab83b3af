"""What a user writes: the mission file, vehicles, a library of named missions."""

from skyknot.missions.mission import Mission, load, names, parse
from skyknot.missions.schema import json_schema

__all__ = ["Mission", "json_schema", "load", "names", "parse"]
