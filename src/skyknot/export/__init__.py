"""How a flight leaves the house: files that other programs read, and what they may rely on."""

from skyknot.export.base import Encoded, Format, Request
from skyknot.export.formats import FORMATS
from skyknot.export.geodesy import Origin, parsed_origin
from skyknot.export.writing import Written, format_named, uncertified_because, write_export

__all__ = [
    "FORMATS",
    "Encoded",
    "Format",
    "Origin",
    "Request",
    "Written",
    "format_named",
    "parsed_origin",
    "uncertified_because",
    "write_export",
]
