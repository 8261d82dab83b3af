// Feasibility restoration: a damped Gauss–Newton descent on the constraint violation.
//
//     minimise ½ Σ d² + ½ Σ (g − clamp(g, l, u))² − μ Σ log(distances of z to its bounds)
//
// Defects become elastic, d = e with cost ½ e², so that one factorisation of the stage problem
// gives the step whatever the ranks. The problem is left as soon as the violation has fallen
// enough for the filter; where it cannot fall further while violated, the program is locally
// infeasible in the least-squares sense (Levenberg–Marquardt; Nocedal & Wright, chapter 10).
#include <cmath>

#include "interior_point.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

constexpr int most_steps = 300;
constexpr double enough = 0.5;     // wanted share of the violation; κ_resto of section 3.3
constexpr double progress = 1e-3;  // a step that lowers it by less is a slow one
constexpr int most_slow_steps = 8;
constexpr double barrier_share = 1e-2;  // of the violation
constexpr double least_damping = 1e-10, most_damping = 1e12;
constexpr double near_feasible = 1e3;  // times the tolerance: too good a point to give up

}  // namespace

Restored InteriorPoint::restore(double tolerance) {
    ++restorations;
    Newton& system = elastic_system();
    const Merit entry = now_;
    const double entry_primal = errors().primal;
    keep_entry();
    clamp_slacks(false);
    // the barrier must not drown a small violation
    const double mu = std::min({1e-4, barrier, barrier_share * violation(false, 0.0)});
    double here = violation(false, mu), damping = 1e-3;
    bool stuck = false;
    int slow = 0;
    for (int count = 0; count < most_steps && seconds() < max_seconds_; ++count) {
        assemble_violation(mu, system);
        const double there = lower_violation(here, mu, damping, system);
        slow = there > (1.0 - progress) * here ? slow + 1 : 0;
        stuck = !(there < here) || slow >= most_slow_steps;
        if (!(there < here)) break;
        here = there;
        take_restored();
        if (now_.theta <= enough * entry.theta && filter_.accepts(now_.theta, now_.phi)) {
            restart(entry);
            return Restored::yes;
        }
        if (stuck) break;
    }
    // An almost feasible or less violated entry point is worth more than where this ended.
    const bool worse = !(now_.theta < entry.theta) || entry_primal <= near_feasible * tolerance;
    if (worse) return_to_entry();
    differentiate();
    gradients();
    // violated, and no step lowers the violation: a stationary point of it
    const bool violated = errors().primal > near_feasible * tolerance;
    return stuck && violated ? Restored::infeasible : Restored::failed;
}

Newton& InteriorPoint::elastic_system() {
    if (!elastic_) elastic_ = std::make_unique<Newton>(points, newton.terminal_tape(), true);
    elastic_->riccati().fixed_first = newton.riccati().fixed_first;
    elastic_->pins = pins;
    elastic_->pin_weight = newton.pin_weight;
    elastic_->elastic_weight = 1.0;
    return *elastic_;
}

// Slacks at the allowed value nearest the path rows, a little inside.
void InteriorPoint::clamp_slacks(bool trial) {
    for (GroupState& group : groups)
        for (int i = 0; i < group.value.rows(); ++i)
            for (int k = 0; k < group.count; ++k) {
                double& slack = (trial ? group.trial_slack : group.slack).row(i)[k];
                if (group.equality.row(i)[k] != 0.0) {
                    slack = group.slack.row(i)[k];
                    continue;
                }
                const double low = group.lower.row(i)[k], high = group.upper.row(i)[k];
                const double inset = std::min(1e-6, 0.01 * (high - low));
                const double value = (trial ? group.trial_value : group.value).row(i)[k];
                slack = std::min(std::max(value, low + inset), high - inset);
            }
}

double InteriorPoint::violation(bool trial, double mu) const {
    double sum = 0.0;
    const RowBuffer& d = trial ? trial_defect_ : defect_;
    for (int i = 0; i < d.rows(); ++i)
        for (int k = 0; k < S_.N; ++k) sum += 0.5 * d.row(i)[k] * d.row(i)[k];
    for (std::size_t g = 0; g < groups.size(); ++g)
        for (int i = 0; i < groups[g].value.rows(); ++i)
            for (int k = 0; k < groups[g].count; ++k) {
                const double r = row_residual(g, i, k, trial);
                sum += 0.5 * r * r;
            }
    double logs = 0.0;
    for (std::size_t b = 0; b < variables_bounded_; ++b)
        logs += bounded_[b].box.log_distances(trial ? bounded_[b].trial : bounded_[b].box.value);
    return sum - mu * logs;
}

// Gauss–Newton system of the violation: Jacobians only, violated rows with weight one.
void InteriorPoint::assemble_violation(double mu, Newton& system) {
    differentiate();
    points.clear_hessian();
    right_.clear();
    std::fill(q_right_.begin(), q_right_.end(), 0.0);
    for (std::size_t g = 0; g < groups.size(); ++g) {
        GroupState& group = groups[g];
        for (int i = 0; i < group.value.rows(); ++i)
            for (int k = 0; k < group.count; ++k) {
                const double r = row_residual(g, i, k, false);
                system.groups[g].weight.row(i)[k] = r != 0.0 ? 1.0 : 0.0;
                group.t.row(i)[k] = r;
            }
        if (g + 1 < groups.size())
            points.add_path_adjoint(static_cast<int>(g), group.t, right_, q_right_.data());
    }
    points.add_rates_transposed(groups.back().t, right_, q_right_.data());
    system.weight_v.clear();
    std::fill(system.weight_q.begin(), system.weight_q.end(), 0.0);
    add_primal_barrier(mu, system);
}

// One accepted step to a trial point, raising the damping until there is one; returns its
// violation, or `here` when there is none.
double InteriorPoint::lower_violation(double here, double mu, double& damping, Newton& system) {
    Direction step = system.direction();
    for (; damping < most_damping; damping *= 8.0) {
        system.regularisation = damping;
        if (!system.factor()) continue;
        system.solve(right_, q_right_.data(), defect_, step, 0);
        direction_.v.copy(step.v);
        direction_.q = step.q;
        double alpha = 1.0;
        for (std::size_t b = 0; b < variables_bounded_; ++b)
            alpha = bounded_[b].box.longest_primal(0.99, alpha);
        make_trial(alpha);
        if (!evaluate(trial_z_, trial_q_.data(), true)) continue;
        clamp_slacks(true);
        const double there = violation(true, mu);
        if (!(there < here - 1e-9 * std::abs(here))) continue;
        alpha_ = alpha;
        damping = std::max(alpha > 0.3 ? damping / 8.0 : damping, least_damping);
        return there;
    }
    return here;
}

void InteriorPoint::take_restored() {
    for (int r = 0; r < S_.v_rows(); ++r) std::copy_n(trial_z_.row(r), S_.count(r), z.row(r));
    repeat_last(z);
    q = trial_q_;
    defect_.copy(trial_defect_);
    objective_ = trial_objective_;
    for (GroupState& group : groups) {
        group.value.copy(group.trial_value);
        group.slack.copy(group.trial_slack);
    }
    ++iterations;
    now_ = merit(false);
}

// Back to the main loop with fresh multipliers.
void InteriorPoint::restart(const Merit& entry) {
    filter_.add(entry.theta, entry.phi);
    for (Bounded& b : bounded_) b.box.reset_multipliers_to(barrier);
    std::fill(pin_multipliers.begin(), pin_multipliers.end(), 0.0);
    estimate_multipliers();
    last_regularisation_ = 0.0;
}

void InteriorPoint::keep_entry() {
    entry_z_.copy(z);
    entry_q_ = q;
    for (std::size_t g = 0; g < groups.size(); ++g) entry_slack_[g].copy(groups[g].slack);
}

void InteriorPoint::return_to_entry() {
    z.copy(entry_z_);
    q = entry_q_;
    for (std::size_t g = 0; g < groups.size(); ++g) groups[g].slack.copy(entry_slack_[g]);
    evaluate(z, q.data(), false);
    now_ = merit(false);
}


// μ/(v − l)² + μ/(u − v)² on the diagonal and the barrier's gradient on the right-hand side.
void InteriorPoint::add_primal_barrier(double mu, Newton& system) {
    for (std::size_t b = 0; b < variables_bounded_; ++b) {
        const Bounded& entry = bounded_[b];
        const std::ptrdiff_t offset = entry.weight - newton.weight_v.origin();
        const bool row = offset >= 0 && static_cast<std::size_t>(offset) < newton.weight_v.size();
        double* weight = row ? system.weight_v.origin() + offset
                             : system.weight_q.data() + (entry.weight - newton.weight_q.data());
        for (int k = 0; k < entry.box.count; ++k) {
            const double below = entry.box.value[k] - entry.box.lower[k];
            const double above = entry.box.upper[k] - entry.box.value[k];
            weight[k] += mu / (below * below) + mu / (above * above);
        }
        entry.box.add_barrier_gradient(mu, entry.gradient);
    }
}

}  // namespace skyknot::inline SKYKNOT_ISA
