"""KML for Google Earth: the track with its times.

Source: OGC 12-007r2, KML 2.3, and Google's extension gx:Track (one ``when`` per ``gx:coord``:
longitude, latitude, altitude). Altitudes are absolute. A time must be a date, so flights begin at
midnight on 1 January 2000, UTC.
"""

from __future__ import annotations

from datetime import timedelta
from xml.sax.saxutils import escape

from skyknot.export.base import EPOCH, Encoded, Format, Request
from skyknot.export.geojson import coordinates

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">
<Document>
<name>{title}</name>
<description>{verdict}</description>
<Style id="track"><LineStyle><color>ffb27200</color><width>4</width></LineStyle></Style>
<Placemark>
<name>{title}</name>
<styleUrl>#track</styleUrl>
<gx:Track>
<altitudeMode>absolute</altitudeMode>
"""
TAIL = """</gx:Track>
</Placemark>
</Document>
</kml>
"""


def encode(request: Request) -> Encoded:
    """Return the document."""
    flight = request.sampled
    moments = [EPOCH + timedelta(milliseconds=round(1e3 * float(t))) for t in flight.times]
    whens = [f"<when>{m:%Y-%m-%dT%H:%M:%S}.{m.microsecond // 1000:03d}Z</when>" for m in moments]
    places = [
        f"<gx:coord>{longitude:.10f} {latitude:.10f} {height:.4f}</gx:coord>"
        for longitude, latitude, height in coordinates(request.place, flight.position)
    ]
    head = HEAD.format(title=escape(request.title), verdict=escape(request.verdict))
    text = head + "\n".join([*whens, *places]) + "\n" + TAIL
    return Encoded(text.encode("utf-8"), "places to 0.1 mm, at whole milliseconds")


KML = Format(
    name="kml",
    title="KML with a timed track",
    file_name="flight.kml",
    encode=encode,
    rate=5.0,
    tick=1e-3,
    needs=("origin",),
)
