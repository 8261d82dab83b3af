"""The table of experiments, in the order of the source report."""

from __future__ import annotations

from skyknot.paper import (
    accuracy,
    convergence,
    efficiency,
    gradient,
    growth,
    open_loop,
    proof,
    reduction,
    stability,
)
from skyknot.paper.base import Experiment

EXPERIMENTS: dict[str, Experiment] = {
    experiment.__name__: experiment
    for experiment in (
        proof.bounds_respected,
        accuracy.global_order,
        accuracy.local_order,
        stability.stability_region,
        stability.step_size_test,
        efficiency.decision_vector,
        growth.linear_in_segments,
        growth.interior_point_growth,
        growth.quadratic_programming_growth,
        gradient.iterations_and_time,
        efficiency.speed_against_general_solver,
        gradient.barzilai_borwein_saving,
        reduction.reduced_order,
        accuracy.defect_at_report_size,
        gradient.optimality_after_iterations,
        convergence.linear_then_superlinear,
        open_loop.arrival,
        accuracy.defects_by_mesh,
        proof.minimum_time,
        open_loop.forward_simulation,
        proof.sensitivity,
        convergence.quadratic_near_solution,
    )
}
"""Experiments by the name under which their findings are kept."""
