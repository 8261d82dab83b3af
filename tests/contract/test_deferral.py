"""Claim: what of a solution is computed when first read is what it would have been at once."""

from __future__ import annotations

import copy
import gc
import pickle
import threading
import weakref
from dataclasses import asdict, dataclass, field, replace

import numpy as np
import pytest

import skyknot as sk
from skyknot.deferral import Deferring
from skyknot.solvers import interior_point
from skyknot.solvers.interior_point import Prepared

LATER = {"costates", "kkt_residual", "max_defect", "witness"}
CART = sk.Problem(
    name="cart",
    states=["x", "v"],
    controls=["a"],
    dynamics=lambda x, u: [x[1], u[0]],
    horizon=1.0,
    initial=[0, 0],
    final=[1, 0],
    running_cost=lambda x, u: u[0] ** 2,
    control_bounds=([-5.0], [5.0]),
)


@dataclass(frozen=True)
class Pair(Deferring):
    """Two numbers, the second of which may come later."""

    first: int
    second: int = field(default_factory=int)


def counted():
    """Return a pair whose second number is counted as it is computed, and the counts."""
    calls = []

    def rest():
        calls.append(threading.get_ident())
        return {"second": 7}

    return Pair.deferred(rest, first=1), calls


READINGS = {
    "attribute": lambda pair: pair.second,
    "repr": repr,
    "equality": lambda pair: pair == Pair(1, 7),
    "replace": lambda pair: replace(pair, first=2).second,
    "asdict": asdict,
    "copy": lambda pair: copy.copy(pair),
    "deep copy": lambda pair: copy.deepcopy(pair),
    "pickle": lambda pair: pickle.loads(pickle.dumps(pair)),
}


@pytest.mark.parametrize("read", READINGS.values(), ids=READINGS)
def test_a_field_is_computed_once_and_the_same_in_every_reading(read):
    pair, calls = counted()
    assert pair.first == 1
    assert calls == []
    assert read(pair) == read(Pair(1, 7))
    assert read(pair) == read(Pair(1, 7))
    assert len(calls) == 1
    assert vars(pair) == vars(Pair(1, 7))


def test_a_name_that_is_no_field_is_refused_without_computing():
    pair, calls = counted()
    with pytest.raises(AttributeError, match="'Pair' object has no attribute 'third'"):
        _ = pair.third
    assert not hasattr(pair, "__array__")
    assert calls == []


def test_threads_that_ask_at_once_get_one_object():
    meeting = threading.Barrier(4)

    def rest():
        meeting.wait(10)
        return {"second": object()}

    pair, found = Pair.deferred(rest, first=1), []
    threads = [threading.Thread(target=lambda: found.append(pair.second)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    assert {id(each) for each in found} == {id(pair.second)}


@pytest.mark.parametrize("solver", ["interior-point", "ipopt"])
def test_a_solve_leaves_to_later_what_few_read(solver):
    solution = sk.solve(CART, sk.HermiteSimpson(6), solver)
    assert set(vars(solution)).isdisjoint(LATER)
    assert "inputs_hash" not in vars(solution.record)
    assert solution.max_defect < 1e-8
    assert set(vars(solution)) >= LATER
    assert len(solution.record.inputs_hash) == 64


def test_writing_into_a_solution_changes_nothing_that_comes_later():
    clean, spoilt = (sk.solve(CART, sk.HermiteSimpson(6)) for _ in range(2))
    for array in (spoilt.decision, spoilt.states, *spoilt.multipliers.values()):
        array[...] = np.pi
    np.testing.assert_array_equal(spoilt.costates, clean.costates)
    np.testing.assert_array_equal(spoilt.witness.defects, clean.witness.defects)
    assert spoilt.kkt_residual == clean.kkt_residual


@pytest.mark.parametrize("threads", [1, 2])
def test_what_comes_later_keeps_no_workspace_alive(threads, monkeypatch):
    made = []

    class Watched(Prepared):
        def __init__(self, program):
            super().__init__(program)
            made.append(weakref.ref(self))

    monkeypatch.setattr(interior_point, "Prepared", Watched)
    starts = [[0, 0], [0.1, 0]]
    scheme = sk.HermiteSimpson(6)
    many = sk.solve_many(CART, initials=starts, transcription=scheme, threads=threads)
    many.append(sk.solve(CART, scheme))
    gc.collect()
    assert [workspace() for workspace in made] == [None, None]
    assert all(solution.max_defect < 1e-8 for solution in many)


def test_a_solution_can_be_pickled_before_anything_else_is_read():
    solution = replace(sk.solve(CART, sk.HermiteSimpson(6)), problem=None)
    again = pickle.loads(pickle.dumps(solution))
    np.testing.assert_array_equal(again.costates, solution.costates)
    assert again.record == solution.record
