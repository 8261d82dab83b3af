"""Where on Earth: a local tangent plane on the WGS 84 ellipsoid.

Legend
------
a, f, e² : semi-major axis (m), flattening, first eccentricity squared. φ, λ : geodetic latitude,
longitude (rad). N(φ) = a/√(1 − e² sin² φ) : prime vertical radius (m). X : Earth-centred
coordinates (m).

Constants: NGA.STND.0036, World Geodetic System 1984, table 3.1. φ from X by the iteration of
B. R. Bowring, "Transformation from spatial to geographical coordinates", Survey Review 181, 1976.

Flight is planned in flat axes. Latitude and longitude are those of the point in the tangent plane;
the altitude is kept, altitude of the origin − z: a level flight stays level over the curved Earth,
where the plane itself would rise by d²/2a, 0.3 m in 2 km and 31 m in 20 km.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError

Array = NDArray[np.float64]

SEMI_MAJOR, FLATTENING = 6378137.0, 1 / 298.257223563
ECCENTRICITY2 = FLATTENING * (2 - FLATTENING)
ITERATIONS = 4


@dataclass(frozen=True)
class Origin:
    """The place of x = y = z = 0.

    Parameters
    ----------
    latitude, longitude : degrees, WGS 84
    altitude : m, above whatever the reader of the file measures from (mean sea level, mostly)

    Raises
    ------
    UserError
        When this is no place on Earth.
    """

    latitude: float
    longitude: float
    altitude: float = 0.0

    def __post_init__(self) -> None:
        sound = abs(self.latitude) <= 90 and abs(self.longitude) <= 180
        if not (sound and np.isfinite(self.altitude)):
            raise UserError(
                "The origin is no place on Earth.",
                where="origin",
                found=f"{self.latitude}, {self.longitude}, {self.altitude}",
                expected="latitude -90 to 90, longitude -180 to 180 [deg], altitude [m]",
                do="Give LAT,LON,ALT in this order, with decimal points.",
            )

    def geodetic(self, position: Array) -> Array:
        """Return latitude [deg], longitude [deg], altitude [m], (M, 3), of NED positions (M, 3)."""
        phi, lam = np.radians([self.latitude, self.longitude])
        north = np.array([-np.sin(phi) * np.cos(lam), -np.sin(phi) * np.sin(lam), np.cos(phi)])
        east = np.array([-np.sin(lam), np.cos(lam), 0.0])
        down = -np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])
        X = _earth_centred(phi, lam, self.altitude) + position @ np.array([north, east, down])
        angles = np.degrees(_latitude_longitude(X))
        return np.column_stack([angles, self.altitude - position[:, 2]])


def parsed_origin(text: str) -> Origin:
    """Return the origin written as "LAT,LON" or "LAT,LON,ALT".

    Raises
    ------
    UserError
        When it is not two or three numbers, or no place on Earth.
    """
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3):
        raise UserError(
            "The origin cannot be read.",
            where="origin",
            found=repr(text),
            expected="LAT,LON,ALT: two angles in degrees and, if known, an altitude in metres",
            do="Write, for instance, --origin 37.2296,-80.4139,634.",
        )
    return Origin(*numbers)


def _earth_centred(phi: float, lam: float, height: float) -> Array:
    N = SEMI_MAJOR / np.sqrt(1 - ECCENTRICITY2 * np.sin(phi) ** 2)
    around = (N + height) * np.cos(phi)
    along = (N * (1 - ECCENTRICITY2) + height) * np.sin(phi)
    return np.array([around * np.cos(lam), around * np.sin(lam), along])


def _latitude_longitude(X: Array) -> Array:
    """Return φ, λ, (M, 2), rad, of Earth-centred points (M, 3)."""
    around = np.hypot(X[:, 0], X[:, 1])
    semi_minor = SEMI_MAJOR * (1 - FLATTENING)
    second = ECCENTRICITY2 / (1 - ECCENTRICITY2)
    beta = np.arctan2(SEMI_MAJOR * X[:, 2], semi_minor * around)
    for _ in range(ITERATIONS):
        phi = np.arctan2(
            X[:, 2] + second * semi_minor * np.sin(beta) ** 3,
            around - ECCENTRICITY2 * SEMI_MAJOR * np.cos(beta) ** 3,
        )
        beta = np.arctan2((1 - FLATTENING) * np.sin(phi), np.cos(phi))
    return np.column_stack([phi, np.arctan2(X[:, 1], X[:, 0])])
