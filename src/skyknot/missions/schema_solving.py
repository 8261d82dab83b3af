"""How the mission is made finite, solved, checked and written."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from skyknot.missions.section import Number, Positive, Section, Triple

SCHEME_NAMES = Literal["hermite-simpson", "trapezoid", "euler", "lobatto", "radau", "chebyshev"]
SOLVER_NAMES = Literal["interior-point", "projected-gradient", "ddp", "ipopt"]


class Scheme(Section):
    """The transcription."""

    name: SCHEME_NAMES = Field(default="hermite-simpson", description="the transcription scheme")
    segments: Annotated[int, Field(ge=1, le=100_000)] = Field(
        default=40, description="number of equal segments of the first mesh"
    )
    accuracy: Annotated[float, Field(ge=1e-10, lt=1)] | Literal["off"] = Field(
        default=1e-4,
        description="the mesh is refined until the error between the nodes, and that of the flight "
        "open loop, is at most this share of the size of each state; 'off': the first mesh alone",
    )
    points: Annotated[int, Field(ge=1, le=200)] | None = Field(
        default=None,
        description="points of a segment: 'lobatto' and 'chebyshev' (2 or more), 'radau'",
    )
    controls: Literal["hold", "linear", "quadratic", "polynomial", "discontinuous"] | None = Field(
        default=None,
        description="how the control runs inside a segment; the scheme's own by default",
    )
    form: Literal["separated", "compressed"] | None = Field(
        default=None,
        description="whether interior states are unknowns; the scheme's own by default",
    )
    enforce: Literal["points", "nodes"] = Field(
        default="points",
        description="where bounds and path constraints hold: every point or nodes only",
    )
    objective: Literal["integral", "sum"] = Field(
        default="integral", description="the integral, or the plain sum over the nodes"
    )


class SolverChoice(Section):
    """The solver."""

    name: SOLVER_NAMES | None = Field(
        default=None, description="the solver; skyknot's own by default"
    )
    tolerance: Annotated[float, Field(gt=0, lt=1)] = Field(
        default=1e-6, description="on the optimality conditions, in the user's units"
    )
    max_iterations: Annotated[int, Field(ge=1)] | None = Field(
        default=None,
        description="stop after this many iterations; the solver's own limit by default",
    )


class Guess(Section):
    """Where the search starts."""

    kind: Literal["straight", "flat", "bow", "via"] = Field(
        description="'straight': straight line at hover; 'flat': minimum-snap lift; 'bow': "
        "straight line bent sideways; 'via': through points"
    )
    offset: Number | None = Field(
        default=None,
        description="of a bow: greatest distance to the right of the line [m]; negative: left",
    )
    points: Annotated[list[Triple], Field(min_length=1)] | None = Field(
        default=None, description="of 'via': points between start and goal, north, east, down [m]"
    )


class Verification(Section):
    """Limits of the certificate that differ from the usual ones."""

    feasibility: Positive | None = Field(
        default=None,
        description="miss of bounds and equations at the scheme's points [unit or share]",
    )
    clearance: Positive | None = Field(
        default=None, description="how far a length may pass its limit between nodes [m]"
    )
    between_nodes: Positive | None = Field(
        default=None, description="how far other limits may be passed between nodes [share]"
    )
    control_excess: Positive | None = Field(
        default=None, description="how far controls may pass their bounds on average [share]"
    )
    dynamics: Positive | None = Field(
        default=None, description="miss of the equations of motion over a segment [share]"
    )
    flight_rms: Positive | None = Field(
        default=None, description="root mean square miss when flown open loop [state unit]"
    )
    arrival: Positive | None = Field(
        default=None, description="miss of the end when flown open loop [share]"
    )
    optimality: Positive | None = Field(
        default=None, description="miss of the optimality conditions of the program solved [share]"
    )
    costate: Positive | None = Field(
        default=None, description="miss of the costate's equation over a segment [share]"
    )
    hamiltonian: Positive | None = Field(
        default=None, description="mean deviation of the Hamiltonian from its constant [share]"
    )
    minimum: Positive | None = Field(
        default=None, description="cost of controls that do not minimise the Hamiltonian [share]"
    )
    curvature: Positive | None = Field(
        default=None, description="negative curvature of the program on its constraints [share]"
    )
    closed_loop: Positive | None = Field(
        default=None, description="miss of the end when flown with feedback [share]"
    )
    perturbed: Positive | None = Field(
        default=None, description="miss of the end with feedback, from starts a little off [share]"
    )


class Outputs(Section):
    """What a run writes besides the solution itself."""

    trajectory_csv: bool = Field(default=True, description="a table of the nodes, trajectory.csv")
    report: bool = Field(
        default=True, description="the one-page report with its figures, report.html"
    )
    figures: bool = Field(
        default=False, description="every figure as a file of its own, PNG and PDF; takes seconds"
    )
