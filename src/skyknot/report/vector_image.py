"""Figures as SVG inside a page: no outside address, colours that follow the page's theme."""

from __future__ import annotations

import re
from html import escape

from skyknot.report import style
from skyknot.report.figures import Illustration, rendered


def inline_svg(illustration: Illustration) -> str:
    """Return an SVG element to stand inside HTML.

    Names inside are made unique to the picture; themed colours become CSS variables such as
    ``var(--ink)``; text stays text, so that it can be searched, read aloud and set in the page's
    own type.
    """
    text = rendered(illustration.figure, "svg").decode()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL)
    text = re.sub(r'\s+xmlns(:\w+)?="[^"]*"', "", text)
    text = text.replace("xlink:href", "href")
    kind = illustration.kind
    text = re.sub(r'\bid="([^"]+)"', rf'id="{kind}-\1"', text)
    text = re.sub(r'href="#([^"]+)"', rf'href="#{kind}-\1"', text)
    text = re.sub(r"url\(#([^)]+)\)", rf"url(#{kind}-\1)", text)
    for name, color in style.THEMED.items():
        text = text.replace(color, f"var(--{name})")
    label = escape(illustration.title, quote=True)
    return re.sub(
        r'<svg [^>]*?(viewBox="[^"]*")[^>]*>',
        rf'<svg \1 role="img" aria-label="{label}">',
        text,
        count=1,
    )
