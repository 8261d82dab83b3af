"""The list of schemes: rows of one table, served by one transcription."""

from __future__ import annotations

import numpy as np

from skyknot.transcription.table import SchemeTable

EULER = SchemeTable(
    name="explicit Euler",
    points=np.array([0.0, 1.0]),
    C=np.array([[1.0, -1.0]]),
    A=np.array([[1.0, 0.0]]),
    b=np.array([1.0, 0.0]),
    order=1,
    stage_order=1,
    control_points={"hold": np.array([0.0])},
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
    source="Hargraves & Paris 1987; Hairer, Lubich & Wanner, Lobatto IIIA with 3 points",
)

SCHEMES = {"euler": EULER, "trapezoid": TRAPEZOID, "hermite-simpson": HERMITE_SIMPSON}
