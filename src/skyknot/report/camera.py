"""Parallel projection of a scene: east, north, up → paper.

Legend: P points (…, 3), east, north, up, m; k vertical stretch; v unit vector towards the viewer,
r to the right, w upward on paper, all in stretched space S P with S = diag(1, 1, k).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def east_north_up(ned: Array) -> Array:
    """Return positions (…, 3) given north, east, down as east, north, up."""
    ned = np.asarray(ned, dtype=float)
    return np.stack([ned[..., 1], ned[..., 0], -ned[..., 2]], axis=-1)


@dataclass(frozen=True)
class Camera:
    """A viewer far away.

    Attributes
    ----------
    azimuth : direction in which the viewer stands, rad from east to north
    elevation : height of the viewer above the horizon, rad
    stretch : k, by which heights are drawn larger
    """

    azimuth: float
    elevation: float
    stretch: float = 1.0

    @cached_property
    def towards(self) -> Array:
        """(3,) v."""
        a, e = self.azimuth, self.elevation
        return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])

    @property
    def ray(self) -> Array:
        """(3,) the direction in unstretched space along which points fall together on paper."""
        return self.towards / self._scale

    def project(self, P: Array) -> Array:
        """Return (…, 2) places on paper."""
        a, e = self.azimuth, self.elevation
        r = np.array([-np.sin(a), np.cos(a), 0.0])
        w = np.array([-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)])
        S = np.asarray(P) * self._scale
        return np.stack([S @ r, S @ w], axis=-1)

    def depth(self, P: Array) -> Array:
        """Return (…,) nearness to the viewer; larger is nearer."""
        result: Array = (np.asarray(P) * self._scale) @ self.towards
        return result

    def unstretched(self, offsets: Array) -> Array:
        """Return the offsets (…, 3) in metres that look like ``offsets`` without a stretch."""
        result: Array = np.asarray(offsets) / self._scale
        return result

    @property
    def _scale(self) -> Array:
        return np.array([1.0, 1.0, self.stretch])
