"""The reference problems, which are at home in ``skyknot.bank``."""

from __future__ import annotations

from skyknot.bank import cart_pole as cart_pole
