"""The section "What binds": limits that are touched, their price in words, and its confirmation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from html import escape
from typing import Any

import numpy as np

from skyknot.report.binding import Binding, Confirmation
from skyknot.report.problem_card import number
from skyknot.report.reading import SYMBOLS, Reading

Pairs = Sequence[tuple[Binding, Confirmation | None]]

FAR = 0.2
"""Share of a bound, or of the objective, beyond which one unit is too much to speak of."""

BRIEF = 0.03
"""Share of the horizon below which a limit is touched at a moment rather than for a while."""


def binds_section(reading: Reading, pairs: Pairs) -> str:
    """Return the section's HTML: a sentence, then every limit with its price and its trial.

    Parameters
    ----------
    pairs : limits that bind, dearest first, each with what solving again found, or None
    """
    if not pairs:
        return (
            '<p class="lead">No limit of the mission binds: moving any of them a little would not'
            " change the answer.</p>"
        )
    rows = "\n".join(_row(reading, binding, trial) for binding, trial in pairs)
    return (
        f'<p class="lead">{escape(lead_sentence(reading, pairs))}</p>\n'
        f'<ul class="prices">\n{rows}\n</ul>\n'
        f'<p class="note">{escape(_note(pairs))}</p>'
    )


def lead_sentence(reading: Reading, pairs: Pairs) -> str:
    """Return the dearest limit in a sentence."""
    binding, trial = pairs[0]
    shown = presented(reading, binding)
    checked = ""
    if trial is not None and trial.success:
        checked = f"; solving again with a small step found {_agreement(binding, trial)}"
    limit, price = _limit(reading, shown), _price(reading, shown, "would save")
    return f"Dearest is {limit}: {price}, at first order{checked}."


def _row(reading: Reading, binding: Binding, trial: Confirmation | None) -> str:
    shown = presented(reading, binding)
    return (
        f"<li><div><b>{escape(_limit(reading, shown))}</b>"
        f'<span class="how">{escape(_when(shown))}</span></div>'
        f"<div>{escape(_price(reading, shown, 'saves'))}</div>"
        f'<div class="trial">{escape(_trial(reading, shown, trial))}</div></li>'
    )


def _limit(reading: Reading, shown: Binding) -> str:
    """Return a limit in words: "speed limit ≤ 8 m/s"."""
    sign = "≤" if shown.upper else "≥"
    return f"{_name(reading, shown)} {sign} {number(shown.bound)} {shown.unit}".rstrip()


def _price(reading: Reading, shown: Binding, verb: str) -> str:
    """Return a price in words: "one m/s more room saves 1.28 of the objective"."""
    amount = unit_step(shown, reading)
    way = "nearer" if _obstacle(reading, shown) is not None else "more room"
    price = f"{_short(shown.price * amount)} {_cost_unit(reading)}"
    return f"{_amount(amount, shown.unit)} {way} {verb} {price}"


def _trial(reading: Reading, shown: Binding, trial: Confirmation | None) -> str:
    """Return what solving again found, in words."""
    if trial is None:
        return "not confirmed: it was not solved again"
    at = f"{number(shown.moved)} {shown.unit}".rstrip()
    if not trial.success:
        return f"not confirmed: solved again with {at}, it ended '{trial.status}'"
    found, foretold = _short(trial.saving), _short(shown.expected)
    text = f"solved again with {at}: {found} saved, {foretold} foretold"
    if not _counts_time(reading) and abs(trial.shorter) > 1e-6 * reading.trajectory.duration:
        way = "shorter" if trial.shorter > 0 else "longer"
        text += f"; {_short(abs(trial.shorter))} s {way}"
    return text


def _short(value: float) -> str:
    return f"{value:.3g}".replace("-", "−")


def _agreement(binding: Binding, trial: Confirmation) -> str:
    return f"{100 * trial.saving / binding.expected:.3g} % of what that price foretells"


def presented(reading: Reading, binding: Binding) -> Binding:
    """Return a limit as people read it: upward, in degrees, a distance to an obstacle in full."""
    obstacle = _obstacle(reading, binding)
    if obstacle is not None:
        return replace(binding, bound=binding.bound + obstacle.sizes.get("clearance", 0.0))
    if binding.kind != "state" or not reading.flies:
        return binding
    factor, unit, _ = reading.presented(binding.names[0])
    return replace(
        binding,
        upper=binding.upper if factor > 0 else not binding.upper,
        bound=factor * binding.bound,
        unit=unit,
        price=binding.price / abs(factor),
        step=abs(factor) * binding.step,
    )


def unit_step(shown: Binding, reading: Reading) -> float:
    """Return how much more room to speak of: one unit, or a tenth, a hundredth … where that is far.

    A price holds at first order, near the limit as it is.
    """
    amount = 1.0
    cost = max(abs(reading.solution.objective), 1e-9)
    while amount > 1e-9 and (
        (shown.bound and amount > FAR * abs(shown.bound)) or amount * shown.price > FAR * cost
    ):
        amount /= 10
    return amount


def _amount(amount: float, unit: str) -> str:
    text = "one" if amount == 1 else f"{amount:g}"
    return f"{text} {unit}" if unit else f"{text} unit" if amount == 1 else text


def _name(reading: Reading, binding: Binding) -> str:
    """Return what a limit is called."""
    if len(binding.names) > 1:
        return "thrust of every rotor"
    (name,) = binding.names
    if binding.kind == "constraint":
        return f"distance to '{name}'" if _obstacle(reading, binding) is not None else name
    return SYMBOLS.get(name, name) if reading.flies else name


def _obstacle(reading: Reading, binding: Binding) -> Any:
    """Return the shape of the obstacle that a limit keeps away from, or None."""
    if binding.kind != "constraint":
        return None
    shapes = {g.name: g.shape for g in reading.problem.path}
    shape = shapes.get(binding.names[0])
    return None if shape is None or shape.keep_in else shape


def _when(binding: Binding) -> str:
    if binding.moment is None:
        return "of the whole flight"
    if binding.active < BRIEF:
        return f"touched at {number(binding.moment)} s"
    return f"touched during {100 * binding.active:.0f} % of the time"


def _counts_time(reading: Reading) -> bool:
    """Whether the objective is the duration itself."""
    duration = reading.trajectory.duration
    return bool(np.isclose(reading.solution.objective, duration, rtol=1e-9, atol=0.0))


def _cost_unit(reading: Reading) -> str:
    return "s" if _counts_time(reading) else "of the objective"


def _note(pairs: Pairs) -> str:
    text = (
        "Prices are the multipliers of the limits, summed over all points where each is asked for;"
        " they hold at first order, near the limits as they are."
    )
    if any(trial is not None for _, trial in pairs):
        text += (
            " Each was tried: the limit moved a little, the mission solved again on the same mesh."
        )
    return text
