"""The list of schemes: rows of one table, served by one transcription."""

from __future__ import annotations

import numpy as np

from skyknot.transcription.collocation import chebyshev, lobatto, radau
from skyknot.transcription.table import Orders, SchemeTable

EULER = SchemeTable(
    name="explicit Euler",
    points=np.array([0.0, 1.0]),
    C=np.array([[1.0, -1.0]]),
    A=np.array([[1.0, 0.0]]),
    b=np.array([1.0, 0.0]),
    order=1,
    stage_order=1,
    control_points={"hold": np.array([0.0])},
    orders={"hold": Orders(1, 1, 1)},
    source="Hairer, Nørsett & Wanner, Solving ODEs I, section I.7",
)

TRAPEZOID = SchemeTable(
    name="trapezoid",
    points=np.array([0.0, 1.0]),
    C=np.array([[1.0, -1.0]]),
    A=np.array([[0.5, 0.5]]),
    b=np.array([0.5, 0.5]),
    order=2,
    stage_order=2,
    control_points={"linear": np.array([0.0, 1.0]), "hold": np.array([0.0])},
    orders={"linear": Orders(2, 1, 2), "hold": Orders(2, 1, 2)},
    source="Betts, Practical Methods for Optimal Control, section 4.5",
)

# Rows: Hermite midpoint, x_c = ½(x_k + x_{k+1}) + (h/8)(f_k − f_{k+1}) (source report (12)), then
# Simpson, d = x_k + (h/6)(f_k + 4 f_c + f_{k+1}) − x_{k+1} (source report (11)).
HERMITE_SIMPSON = SchemeTable(
    name="Hermite–Simpson",
    points=np.array([0.0, 0.5, 1.0]),
    C=np.array([[0.5, -1.0, 0.5], [1.0, 0.0, -1.0]]),
    A=np.array([[1 / 8, 0.0, -1 / 8], [1 / 6, 4 / 6, 1 / 6]]),
    b=np.array([1 / 6, 4 / 6, 1 / 6]),
    order=4,
    stage_order=3,
    control_points={
        "quadratic": np.array([0.0, 0.5, 1.0]),
        "linear": np.array([0.0, 1.0]),
        "hold": np.array([0.0]),
    },
    orders={"quadratic": Orders(4, 2, 4), "linear": Orders(4, 2, 4), "hold": Orders(2, 1, 2)},
    source="Hargraves & Paris 1987; Hairer, Lubich & Wanner, Lobatto IIIA with 3 points",
)

SCHEMES = {
    "euler": EULER,
    "trapezoid": TRAPEZOID,
    "hermite-simpson": HERMITE_SIMPSON,
    "lobatto": lobatto(5),
    "radau": radau(4),
    "chebyshev": chebyshev(5),
}
"""Name in mission files → table; of a family, the one with as many points as its door has."""
