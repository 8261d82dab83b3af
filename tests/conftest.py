"""Shared by all rooms: property tests are reproducible; rooms may import each other's banks."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("reproducible", derandomize=True, deadline=None, max_examples=40)
settings.load_profile("reproducible")
