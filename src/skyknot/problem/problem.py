"""What is asked, in continuous time: states, controls, dynamics, costs, constraints, ends."""

from __future__ import annotations

import copy
import inspect
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.problem.constraints import PathConstraint, PointConstraint
from skyknot.problem.horizon import Free
from skyknot.problem.variables import Control, State, bound_arrays, filled, named

Array = NDArray[np.float64]
Ends = Sequence[float | tuple[float | None, float | None] | None] | None


class Problem:
    """An optimal control problem in continuous time; no mesh, no solver.

    minimise  ∫ running_cost dt + terminal_cost   subject to  dx/dt = dynamics(x, u), bounds,
    path, point and rate constraints, and the ends.

    Parameters
    ----------
    name : str
    states, controls : names, or State and Control with unit and bounds
    dynamics : ``(x, u)`` of CasADi symbols → nx rates; may also take arguments named ``p``, ``t``
    horizon : duration [s], or ``Free(lower, upper, guess)``
    initial, final : one entry per state: a number, None (free) or a pair (lower, upper)
    running_cost : ``(x, u)`` → expression, per second; optional
    terminal_cost : ``(x, tf)`` → expression; optional
    state_bounds, control_bounds : pairs (lower, upper) of numbers or lists; None entries are free
    path : PathConstraint entries
    points : PointConstraint entries (waypoints, terminal conditions)
    rates : pair (lower, upper) of bounds on du/dt, or one list of symmetric bounds; None is free
    parameters : name → value, or Free to let the optimiser choose; ``p.name`` in the callables
    target : state aimed at, for the guess and the pictures, where ``final`` is free
    vehicle : vehicle flown, if any: gives trim, scales, flatness lift and the craft to draw
    frame : frame of the positions

    Raises
    ------
    UserError
        When sizes disagree, bounds leave no room, or a callable does not return what it should.
    """

    def __init__(
        self,
        name: str,
        states: Sequence[str | State],
        controls: Sequence[str | Control],
        dynamics: Callable[..., Any],
        horizon: float | Free,
        initial: Ends = None,
        final: Ends = None,
        running_cost: Callable[..., Any] | None = None,
        terminal_cost: Callable[..., Any] | None = None,
        state_bounds: tuple[Any, Any] | None = None,
        control_bounds: tuple[Any, Any] | None = None,
        path: Sequence[PathConstraint] = (),
        points: Sequence[PointConstraint] = (),
        rates: Any = None,
        parameters: Mapping[str, float | Free] | None = None,
        target: Sequence[float] | None = None,
        vehicle: Any = None,
        frame: str = "NED",
    ) -> None:
        self.name = name
        self.states = named(states, State, "states")
        self.controls = named(controls, Control, "controls")
        self.dynamics, self.running_cost, self.terminal_cost = dynamics, running_cost, terminal_cost
        self.horizon = _checked_horizon(horizon)
        self.state_lower, self.state_upper = bound_arrays(self.states, state_bounds, "state_bounds")
        self.control_lower, self.control_upper = bound_arrays(
            self.controls, control_bounds, "control_bounds"
        )
        self.initial_lower, self.initial_upper = self._ends(initial, "initial")
        self.final_lower, self.final_upper = self._ends(final, "final")
        self.path, self.points = tuple(path), tuple(points)
        self.rate_lower, self.rate_upper = _rate_bounds(rates, self.controls)
        self.parameters = dict(parameters or {})
        self.target = None if target is None else filled(target, self.nx, np.nan, "target")
        self.vehicle, self.frame = vehicle, frame
        self._check_names()
        self._check_callables()

    @property
    def nx(self) -> int:
        """Number of states."""
        return len(self.states)

    @property
    def nu(self) -> int:
        """Number of controls."""
        return len(self.controls)

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states, in order."""
        return tuple(state.name for state in self.states)

    @property
    def control_names(self) -> tuple[str, ...]:
        """Names of the controls, in order."""
        return tuple(control.name for control in self.controls)

    @property
    def constraints(self) -> tuple[PathConstraint | PointConstraint, ...]:
        """Path constraints, then point constraints."""
        return (*self.path, *self.points)

    @property
    def free_horizon(self) -> bool:
        """Whether the duration is chosen by the optimiser."""
        return isinstance(self.horizon, Free)

    @property
    def duration_guess(self) -> float:
        """The fixed duration, or where the search for it starts, s."""
        return self.horizon.start if isinstance(self.horizon, Free) else self.horizon

    @property
    def free_parameters(self) -> dict[str, Free]:
        """Parameters chosen by the optimiser."""
        return {key: value for key, value in self.parameters.items() if isinstance(value, Free)}

    def parameter_values(self) -> dict[str, float]:
        """Return every parameter's value, or its start where it is free."""
        return {
            key: value.start if isinstance(value, Free) else float(value)
            for key, value in self.parameters.items()
        }

    def varied(
        self, parameters: Mapping[str, float] | None = None, initial: Ends = None
    ) -> Problem:
        """Return the same problem with other numbers; callables are not checked again.

        Parameters
        ----------
        parameters : values by name for some of the parameters that are not free
        initial : as for the constructor; None keeps what is there

        Raises
        ------
        UserError
            When a parameter is unknown or free, a value is not finite, or the initial state does
            not fit.
        """
        other = copy.copy(self)
        given = dict(parameters or {})
        for name, value in given.items():
            self._check_parameter(name, value)
        other.parameters = self.parameters | {name: float(value) for name, value in given.items()}
        if initial is not None:
            other.initial_lower, other.initial_upper = self._ends(initial, "initial")
        return other

    def _check_parameter(self, name: str, value: object) -> None:
        fixed = [key for key in self.parameters if key not in self.free_parameters]
        if name not in fixed:
            raise UserError(
                "There is no parameter of this name whose value can be given.",
                where="parameters",
                found=name,
                expected=", ".join(fixed) or "a problem with parameters",
                do="Name a parameter of the problem that is not Free.",
            )
        if not isinstance(value, int | float) or not np.isfinite(value):
            raise UserError(
                "The value of a parameter is not a finite number.",
                where=f"parameters, {name}",
                found=value,
                expected="a finite number",
                do=f"Give {name} a number.",
            )

    def rates_of(self, x: Any, u: Any, p: Mapping[str, Any], t: Any) -> Any:
        """Return dx/dt as a column (nx, 1) of CasADi expressions."""
        return column(call(self.dynamics, x, u, p=p, t=t))

    def running_cost_of(self, x: Any, u: Any, p: Mapping[str, Any], t: Any) -> Any:
        """Return the running cost per second; zero when there is none."""
        return 0 if self.running_cost is None else call(self.running_cost, x, u, p=p, t=t)

    def terminal_cost_of(self, x: Any, p: Mapping[str, Any], tf: Any) -> Any:
        """Return the terminal cost; zero when there is none."""
        return 0 if self.terminal_cost is None else call(self.terminal_cost, x, tf, p=p, t=tf)

    def constraints_of(self, x: Any, u: Any, p: Mapping[str, Any], t: Any) -> Any:
        """Return path constraints, then point constraints, as a column of expressions."""
        entries = self.constraints
        if not entries:
            return ca.SX(0, 1)
        return ca.vertcat(*[scalar(call(entry.function, x, u, p=p, t=t)) for entry in entries])

    def _ends(self, entries: Ends, field: str) -> tuple[Array, Array]:
        if entries is None:
            return np.full(self.nx, -np.inf), np.full(self.nx, np.inf)
        if len(entries) != self.nx:
            raise UserError(
                f"The {field} state has the wrong number of entries.",
                where=field,
                found=f"{len(entries)} entries",
                expected=f"{self.nx}: {', '.join(self.state_names)}",
                do="Give one entry per state; None leaves it free.",
            )
        pairs = [entry if isinstance(entry, tuple) else (entry, entry) for entry in entries]
        lower = filled([low for low, _ in pairs], self.nx, -np.inf, field)
        upper = filled([high for _, high in pairs], self.nx, np.inf, field)
        self._check_ends_inside(lower, upper, field)
        return lower, upper

    def _check_ends_inside(self, lower: Array, upper: Array, field: str) -> None:
        for i, state in enumerate(self.states):
            apart = lower[i] > self.state_upper[i] or upper[i] < self.state_lower[i]
            if apart or lower[i] > upper[i]:
                raise UserError(
                    f"The {field} {state.name} lies outside its bounds.",
                    where=f"{field}, {state.name}",
                    found=f"{lower[i]:g} to {upper[i]:g} {state.unit}".rstrip(),
                    expected=f"within {self.state_lower[i]:g} to {self.state_upper[i]:g}",
                    do=f"Change the {field} {state.name} or its bounds.",
                )

    def _check_names(self) -> None:
        names = [*self.state_names, *self.control_names]
        constraints = [entry.name for entry in self.constraints]
        for group, field in ((names, "states and controls"), (constraints, "constraints")):
            repeated = sorted({name for name in group if group.count(name) > 1})
            if repeated:
                raise UserError(
                    f"Names of {field} repeat.",
                    where=field,
                    found=", ".join(repeated),
                    expected="every name used once",
                    do="Rename one of them.",
                )

    def _check_callables(self) -> None:
        x, u = ca.SX.sym("x", self.nx), ca.SX.sym("u", self.nu)
        p, t = symbols(tuple(self.parameters)), ca.SX.sym("t")
        rates = _tried(lambda: self.rates_of(x, u, p, t), "dynamics")
        if rates.shape[0] != self.nx:
            raise UserError(
                "The dynamics return the wrong number of rates.",
                where="dynamics",
                found=f"{rates.shape[0]} rates",
                expected=f"{self.nx}: one for each of {', '.join(self.state_names)}",
                do="Return one rate per state, in the order of the states.",
            )
        _tried(lambda: scalar(self.running_cost_of(x, u, p, t)), "running_cost")
        _tried(lambda: scalar(self.terminal_cost_of(x, p, t)), "terminal_cost")
        for entry in self.constraints:
            _tried(partial(_scalar_call, entry.function, x, u, p, t), entry.name)


class Parameters(dict[str, Any]):
    """Parameters by name: ``p.mass`` or ``p["mass"]``."""

    def __getattr__(self, name: str) -> Any:
        if name in self:
            return self[name]
        raise AttributeError(f"no parameter '{name}'; there are: {', '.join(self) or 'none'}")


def symbols(names: Sequence[str]) -> Parameters:
    """Return a CasADi SX symbol for each name."""
    return Parameters({name: ca.SX.sym(name) for name in names})


def call(function: Callable[..., Any], first: Any, second: Any, **named_values: Any) -> Any:
    """Call with two positional arguments, and ``p`` or ``t`` where the function asks for them.

    A third positional argument under any other name receives the parameters.
    """
    wanted = list(inspect.signature(function).parameters)[2:]
    values = {name: named_values.get(name, named_values["p"]) for name in wanted}
    if isinstance(values.get("p"), dict) and not isinstance(values["p"], Parameters):
        values["p"] = Parameters(values["p"])
    return function(first, second, **values)


def column(values: Any) -> Any:
    """Return a list of expressions, or a vector, as a CasADi column."""
    return ca.vertcat(*values) if isinstance(values, list | tuple | np.ndarray) else ca.vec(values)


def scalar(value: Any) -> Any:
    """Return the one entry of an expression; raise ValueError when there are more."""
    expression = column(value) if isinstance(value, list | tuple | np.ndarray) else value
    if tuple(getattr(expression, "shape", ())) not in ((), (1,), (1, 1)):
        raise ValueError(f"returned shape {tuple(expression.shape)}, one number was expected")
    return expression


def _scalar_call(function: Callable[..., Any], x: Any, u: Any, p: Any, t: Any) -> Any:
    return scalar(call(function, x, u, p=p, t=t))


def _tried(evaluate: Callable[[], Any], field: str) -> Any:
    try:
        expression = evaluate()
        if _holds_nan(expression):
            raise ValueError("a function of math or numpy turned a symbol into NaN")
        return expression
    except UserError:
        raise
    except (TypeError, ValueError, IndexError, AttributeError, RuntimeError, KeyError) as error:
        raise UserError(
            f"'{field}' cannot be evaluated on CasADi symbols.",
            where=field,
            found=f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}",
            expected="a function of (x, u), optionally with p and t, built from CasADi operations",
            do="Use casadi.sin, casadi.sqrt, … instead of math or numpy, and check the indices.",
        ) from error
    except NotImplementedError as error:
        raise UserError(
            f"'{field}' uses an operation that CasADi does not know.",
            where=field,
            found=str(error).splitlines()[0],
            expected="CasADi operations",
            do="Replace the operation by its CasADi counterpart.",
        ) from error


def _holds_nan(expression: Any) -> bool:
    """Whether a constant inside is NaN: what math.sin makes of a symbol, without an error."""
    function = ca.Function("expression", ca.symvar(ca.SX(expression)), [ca.SX(expression)])
    constants = (
        function.instruction_constant(k)
        for k in range(function.n_instructions())
        if function.instruction_id(k) == ca.OP_CONST
    )
    return any(np.isnan(constant) for constant in constants)


def _checked_horizon(horizon: float | Free) -> float | Free:
    if isinstance(horizon, Free):
        low = horizon.lower
    else:
        low = horizon = float(horizon)
    if not (low > 0 and np.isfinite(low)):
        raise UserError(
            "The horizon must be a positive time.",
            where="horizon",
            found=f"{low:g} s",
            expected="a positive number of seconds, or Free(lower, upper) with lower > 0",
            do="Give the duration in seconds.",
        )
    return horizon


def _rate_bounds(rates: Any, controls: tuple[Control, ...]) -> tuple[Array, Array]:
    if rates is None or (isinstance(rates, tuple) and len(rates) == 2):
        free = [Control(f"d{control.name}/dt", f"{control.unit}/s") for control in controls]
        return bound_arrays(free, rates, "rates")
    upper = filled(rates, len(controls), np.inf, "rates")
    if not np.all(upper >= 0):
        raise UserError(
            "Symmetric bounds on rates cannot be negative.",
            where="rates",
            found=f"{upper}",
            expected="largest |du/dt| of each control, or a pair (lower, upper)",
            do="Give magnitudes, or a pair of lists.",
        )
    return -upper, upper
