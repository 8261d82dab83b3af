#include "interior_point.hpp"

#include <chrono>
#include <cmath>

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double clock_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Constants of the paper: (8) and (19)–(23), section 3.1.
constexpr double kappa_epsilon = 10.0, kappa_mu = 0.2, theta_mu = 1.5, tau_min = 0.99, s_max = 100.0;
constexpr double delta_first = 1e-2, delta_smallest = 1e-20, delta_largest = 1e20;
// A regularisation above this was needed so clearly that the next try starts from a third of it.
constexpr double delta_persistent = 0.1;
constexpr double short_step = 3e-3;  // relative; gains change about as much

}  // namespace

GroupState::GroupState(const Structure& S, int rows, int columns)
    : value(S, rows), slack(S, rows), slack_step(S, rows), y(S, rows), y_step(S, rows),
      lower(S, rows), upper(S, rows), zl(S, rows), zu(S, rows), dzl(S, rows), dzu(S, rows),
      equality(S, rows), active(S, rows), r_slack(S, rows), t(S, rows), trial_value(S, rows),
      trial_slack(S, rows), unscale(at(rows), 1.0), count(columns) {}

InteriorPoint::InteriorPoint(const Structure& S, const Tape& value, const Tape& full,
                             const Tape& terminal)
    : z(S, S.v_rows()), lower(S, S.v_rows()), upper(S, S.v_rows()), scale(S, S.v_rows()),
      q(at(S.nq)), q_lower(at(S.nq)), q_upper(at(S.nq)), q_scale(at(S.nq), 1.0),
      defect_scale(at(S.nx), 1.0), lambda(S, S.interior()), zl(S, S.v_rows()), zu(S, S.v_rows()),
      q_zl(at(S.nq)), q_zu(at(S.nq)), points(S, value, full), newton(points, terminal, false),
      S_(S), direction_(newton.direction()), dzl_(S, S.v_rows()), dzu_(S, S.v_rows()),
      cost_gradient_(S, S.v_rows()), lagrangian_(S, S.v_rows()), right_(S, S.v_rows()),
      defect_(S, S.interior()), trial_defect_(S, S.interior()), used_defect_(S, S.interior()),
      trial_z_(S, S.v_rows()), cost_step_(S, S.v_rows()), entry_z_(S, S.v_rows()), dq_zl_(at(S.nq)), dq_zu_(at(S.nq)),
      q_cost_(at(S.nq)), q_lagrangian_(at(S.nq)), q_right_(at(S.nq)), q_step_right_(at(S.nq)),
      trial_q_(at(S.nq)) {
    for (int c = 0; c <= S.classes(); ++c) {
        const bool rates = c == S.classes();
        const int rows = rates ? static_cast<int>(S.rates.size()) : S.ng;
        groups.emplace_back(S, rows, rates ? S.N : S.class_count(c));
        used_rows_.emplace_back(S, rows);
        entry_slack_.emplace_back(S, rows);
    }
    history.reserve(4096);
}

double InteriorPoint::seconds() const { return clock_seconds() - started_; }

Outcome InteriorPoint::solve(const Settings& settings,
                             const std::function<bool(const Record&)>& watch) {
    started_ = clock_seconds();
    max_seconds_ = settings.max_seconds;
    refinements_ = settings.refinements;
    const double floor = settings.tolerance * std::min(1.0, objective_scale) / (kappa_epsilon + 1);
    ended_by_short_step_ = false;
    if (!initialise(settings)) return Outcome::evaluation;
    for (iterations = 0;; ++iterations) {
        // ---- where we stand -------------------------------------------------------------
        differentiate();
        gradients();
        const Errors e = errors();
        record(e);
        if (watch && watch(history.back())) return Outcome::interrupted;
        if (e.total <= settings.tolerance) return Outcome::solved;
        if (!std::isfinite(e.total)) return Outcome::evaluation;
        const double acceptable = settings.tolerance * settings.acceptable_factor;
        if (iterations >= settings.max_iterations) return give_up(e, acceptable, Outcome::iterations);
        if (diverging()) return Outcome::unbounded;
        if (seconds() > settings.max_seconds) return give_up(e, acceptable, Outcome::seconds);
        // ---- barrier --------------------------------------------------------------------
        while (update_barrier(e, floor)) {}
        // ---- direction ------------------------------------------------------------------
        ended_by_short_step_ = false;
        if (!factor()) {
            const Restored restored = restore(settings.tolerance);
            if (restored == Restored::infeasible) return Outcome::infeasible;
            if (restored == Restored::failed) return give_up(e, acceptable, Outcome::stalled);
            continue;
        }
        assemble(barrier);
        solve_step();
        // ---- step length ----------------------------------------------------------------
        if (!line_search(std::max(tau_min, 1.0 - barrier))) {
            if (e.total <= acceptable) return Outcome::acceptable;
            const Restored restored = restore(settings.tolerance);
            if (restored == Restored::infeasible) return Outcome::infeasible;
            if (restored == Restored::failed) return give_up(e, acceptable, Outcome::stalled);
            continue;
        }
        // ---- move -----------------------------------------------------------------------
        take_trial();
        ended_by_short_step_ = newton.regularisation == 0.0 && relative_step() < short_step;
    }
}

// An objective without a lower bound sends the iterates away.
bool InteriorPoint::diverging() const { return objective_ < -1e15; }

Outcome InteriorPoint::give_up(const Errors& e, double tolerance, Outcome otherwise) const {
    return e.total <= tolerance ? Outcome::acceptable : otherwise;
}

// Values at a point: objective, defects, path rows. False when something is not a number.
bool InteriorPoint::evaluate(const RowBuffer& here, const double* here_q, bool trial) {
    points.evaluate(here, here_q);
    points.defects(here, trial ? trial_defect_ : defect_);
    for (int c = 0; c < S_.classes(); ++c)
        for (int i = 0; i < S_.ng; ++i) {
            RowBuffer& to = trial ? groups[at(c)].trial_value : groups[at(c)].value;
            points.rows[at(c)].copy_row(S_.row_g() + i, S_.class_count(c), to.row(i));
        }
    points.rates(here, here_q, trial ? groups.back().trial_value : groups.back().value);
    newton.evaluate_terminal(here, here_q, objective_scale);
    double& value = (trial ? trial_objective_ : objective_) = points.cost_sum() + newton.terminal_value;
    const Merit found = merit(trial);
    if (trial) trial_merit_ = found;
    return std::isfinite(value) && std::isfinite(found.theta);
}

double InteriorPoint::row_residual(std::size_t g, int i, int k, bool trial) const {
    const GroupState& group = groups[g];
    return group.active.row(i)[k] *
           ((trial ? group.trial_value : group.value).row(i)[k] -
            (trial ? group.trial_slack : group.slack).row(i)[k]);
}

InteriorPoint::Merit InteriorPoint::merit(bool trial) const {
    Merit m{trial ? trial_objective_ : objective_, 0.0};
    for (const Bounded& b : bounded_)
        m.phi -= barrier * b.box.log_distances(trial ? b.trial : b.box.value);
    const RowBuffer& d = trial ? trial_defect_ : defect_;
    for (int i = 0; i < d.rows(); ++i) m.theta += sum_absolute(d.row(i), S_.N);
    for (std::size_t g = 0; g < groups.size(); ++g)
        for (int i = 0; i < groups[g].value.rows(); ++i)
            for (int k = 0; k < groups[g].count; ++k)
                m.theta += std::abs(row_residual(g, i, k, trial));
    return m;
}

void InteriorPoint::differentiate() {
    points.differentiate(z, q.data(), lambda, y_);
    newton.evaluate_terminal(z, q.data(), objective_scale);
}

// Gradients of the objective and of the Lagrangian without bound multipliers.
void InteriorPoint::gradients() {
    cost_gradient_.clear();
    std::fill(q_cost_.begin(), q_cost_.end(), 0.0);
    points.add_cost_gradient(cost_gradient_, q_cost_.data());
    for (int i = 0; i < S_.nx; ++i)
        cost_gradient_.row(S_.state_row(0, i))[S_.N] += newton.terminal_gradient[at(i)];
    for (int i = 0; i < S_.nq; ++i) q_cost_[at(i)] += newton.terminal_gradient[at(S_.nx + i)];
    lagrangian_.copy(cost_gradient_);
    q_lagrangian_ = q_cost_;
    points.add_adjoint(lambda, y_, lagrangian_, q_lagrangian_.data());
    points.add_rates_transposed(groups.back().y, lagrangian_, q_lagrangian_.data());
    for (std::size_t p = 0; p < pins.size(); ++p)
        lagrangian_.row(pins[p].row)[pins[p].k] += pin_multipliers[p];
}

void InteriorPoint::complete_fixed() {
    for (int i = 0; i < S_.nx; ++i)
        if (newton.fixed_first(i)) zu.row(S_.state_row(0, i))[0] = -lagrangian_.row(S_.state_row(0, i))[0];
    for (std::size_t p = 0; p < pins.size(); ++p)
        zu.row(pins[p].row)[pins[p].k] = pin_multipliers[p] - lagrangian_.row(pins[p].row)[pins[p].k];
}

double InteriorPoint::multiplier_scale() const {
    double sum = 0.0, count = static_cast<double>(lambda.rows()) * S_.N;
    for (int i = 0; i < lambda.rows(); ++i) sum += sum_absolute(lambda.row(i), S_.N);
    for (const Bounded& b : bounded_) sum += b.box.multiplier_sum(), count += b.box.count;
    return std::max(s_max, sum / std::max(1.0, count)) / s_max;
}

// Residuals in the user's units; `total` divides by the size of the multipliers as in (5)–(6).
InteriorPoint::Errors InteriorPoint::errors() const {
    Errors e{0.0, 0.0, 0.0, 0.0};
    double unreal = 0.0;  // stays zero while every gradient is finite; a maximum would hide a NaN
    for (int r = 0; r < S_.v_rows(); ++r) {
        const int from = r < S_.nx && newton.fixed_first(r) ? 1 : 0, count = S_.count(r) - from;
        const double *g = lagrangian_.row(r) + from, *u = zu.row(r) + from, *l = zl.row(r) + from;
        const double most = row_bounded_[at(r)]
                                ? largest(count, 0.0, [=](auto read) SKYKNOT_LAMBDA {
                                      return absolute(read(g) + read(u) - read(l));
                                  })
                                : largest_absolute(g, count);
        unreal += total(count, [=](auto read) SKYKNOT_LAMBDA { return 0.0 * read(g); });
        e.dual = std::max(e.dual, most / scale.row(r)[0]);
    }
    for (std::size_t i = 0; i < q.size(); ++i) {
        e.dual = std::max(e.dual, std::abs(q_lagrangian_[i] + q_zu[i] - q_zl[i]) / q_scale[i]);
        unreal += 0.0 * q_lagrangian_[i];
    }
    for (int i = 0; i < defect_.rows(); ++i) {
        const double most = largest_absolute(defect_.row(i), S_.N);
        e.primal = std::max(e.primal, most * defect_scale[at(i % S_.nx)]);
    }
    for (std::size_t g = 0; g < groups.size(); ++g)
        for (int i = 0; i < groups[g].value.rows(); ++i)
            for (int k = 0; k < groups[g].count; ++k) {
                const GroupState& group = groups[g];
                const double off = std::abs(row_residual(g, i, k, false));
                e.primal = std::max(e.primal, off * group.unscale[at(i)]);
                const double free = group.active.row(i)[k] * (1.0 - group.equality.row(i)[k]);
                const double dual = group.zu.row(i)[k] - group.zl.row(i)[k] - group.y.row(i)[k];
                e.dual = std::max(e.dual, free * std::abs(dual) / group.unscale[at(i)]);
            }
    for (const Bounded& b : bounded_)
        e.complementarity = std::max(e.complementarity, b.box.complementarity(0.0));
    e.dual /= objective_scale, e.complementarity /= objective_scale;
    e.size = multiplier_scale();
    e.total = std::max({e.dual / e.size, e.primal, e.complementarity / e.size}) + unreal;
    return e;
}

// (7): lower the barrier once its problem is solved well enough; true when it was lowered.
bool InteriorPoint::update_barrier(const Errors& e, double floor) {
    if (barrier <= floor) return false;
    double complementarity = 0.0;
    for (const Bounded& b : bounded_)
        complementarity = std::max(complementarity, b.box.complementarity(barrier));
    const double dual = e.dual * objective_scale;
    const double error = std::max({dual / e.size, e.primal, complementarity / e.size});  // E_μ
    if (error > kappa_epsilon * barrier) return false;
    barrier = std::max(floor, std::min(kappa_mu * barrier, std::pow(barrier, theta_mu)));
    now_ = merit(false);
    filter_.reset(1e4 * std::max(1.0, theta_start_));
    return true;
}

// Inertia correction, section 3.1: raise δ_w until the reduced Hessian is positive definite.
bool InteriorPoint::factor() {
    newton.weight_v.clear();
    std::fill(newton.weight_q.begin(), newton.weight_q.end(), 0.0);
    for (Group& group : newton.groups) group.weight.clear();
    for (const Bounded& b : bounded_) b.box.add_sigma(b.weight);
    newton.regularisation = 0.0;
    const bool still_needed = history.back().regularisation > delta_persistent;
    if (!still_needed && newton.factor()) return true;
    double delta = last_regularisation_ == 0.0
                       ? delta_first
                       : std::max(delta_smallest, last_regularisation_ / 3.0);
    const double growth = last_regularisation_ == 0.0 ? 100.0 : 8.0;
    for (; delta < delta_largest; delta *= growth) {
        newton.regularisation = delta;
        if (newton.factor()) {
            last_regularisation_ = delta;
            return true;
        }
    }
    return false;
}

// Right-hand side of the Newton system from the defects and `used_rows_` (g − s).
void InteriorPoint::assemble(double mu) {
    defect_in_use_ = &defect_;
    for (std::size_t g = 0; g < groups.size(); ++g)
        for (int i = 0; i < groups[g].value.rows(); ++i)
            for (int k = 0; k < groups[g].count; ++k)
                used_rows_[g].row(i)[k] = row_residual(g, i, k, false);
    right_.copy(lagrangian_);
    q_right_ = q_lagrangian_;
    for (GroupState& group : groups)
        for (int i = 0; i < group.y.rows(); ++i)
            for (int k = 0; k < group.count; ++k)
                group.r_slack.row(i)[k] =
                    group.equality.row(i)[k] == 0.0 ? -group.y.row(i)[k] : 0.0;
    for (Bounded& b : bounded_) b.box.add_barrier_gradient(mu, b.gradient);
}

// Solves for the step with the residuals in use; fills slack, multiplier and bound steps.
void InteriorPoint::solve_step() {
    const RowBuffer* gradient = &right_;
    q_step_right_ = q_right_;
    if (has_rows_) cost_step_.copy(right_), gradient = &cost_step_;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        GroupState& group = groups[g];
        Group& rows = newton.groups[g];
        for (int i = 0; i < group.y.rows(); ++i)
            for (int k = 0; k < group.count; ++k) {
                const double r = used_rows_[g].row(i)[k];
                group.t.row(i)[k] = rows.weight.row(i)[k] * r + group.r_slack.row(i)[k];
                rows.residual.row(i)[k] = group.equality.row(i)[k] * r;
            }
        if (g + 1 < groups.size())
            points.add_path_adjoint(static_cast<int>(g), group.t, cost_step_, q_step_right_.data());
    }
    points.add_rates_transposed(groups.back().t, cost_step_, q_step_right_.data());
    newton.solve(*gradient, q_step_right_.data(), *defect_in_use_, direction_, refinements_);
    for (std::size_t g = 0; g < groups.size(); ++g) {
        GroupState& group = groups[g];
        const Group& rows = newton.groups[g];
        for (int i = 0; i < group.y.rows(); ++i)
            for (int k = 0; k < group.count; ++k) {
                const double along = rows.linear.row(i)[k] + used_rows_[g].row(i)[k];
                const bool equality = group.equality.row(i)[k] != 0.0;
                group.slack_step.row(i)[k] = equality ? 0.0 : along;
                group.y_step.row(i)[k] = equality ? direction_.equality[g].row(i)[k]
                                                  : rows.weight.row(i)[k] * along +
                                                        group.r_slack.row(i)[k];
            }
    }
    for (Bounded& b : bounded_) b.box.multiplier_steps(barrier);
}

// Lanes past the last segment evaluate a copy of it.
void InteriorPoint::repeat_last(RowBuffer& rows) const {
    for (int r = 0; r < S_.v_rows(); ++r)
        std::fill(rows.row(r) + S_.count(r), rows.row(r) + rows.stride() - Structure::front,
                  rows.row(r)[S_.count(r) - 1]);
}

void InteriorPoint::take_trial() {
    for (int r = 0; r < S_.v_rows(); ++r) std::copy_n(trial_z_.row(r), S_.count(r), z.row(r));
    repeat_last(z);
    q = trial_q_;
    for (int i = 0; i < lambda.rows(); ++i)
        for (int k = 0; k < S_.N; ++k) lambda.row(i)[k] += alpha_ * direction_.lambda.row(i)[k];
    for (GroupState& group : groups) {
        for (int i = 0; i < group.y.rows(); ++i)
            for (int k = 0; k < group.count; ++k) {
                group.y.row(i)[k] += alpha_ * group.y_step.row(i)[k];
                group.slack.row(i)[k] = group.trial_slack.row(i)[k];
                group.value.row(i)[k] = group.trial_value.row(i)[k];
            }
    }
    defect_.copy(trial_defect_);
    objective_ = trial_objective_;
    for (std::size_t p = 0; p < pins.size(); ++p) pin_multipliers[p] += alpha_ * direction_.pins[p];
    for (Bounded& b : bounded_) b.box.move_multipliers(alpha_dual_, barrier);
    now_ = trial_merit_;
}

void InteriorPoint::record(const Errors& e) {
    history.push_back({objective_ / objective_scale, e.primal, e.dual, barrier, alpha_,
                       newton.regularisation});
}

}  // namespace skyknot::inline SKYKNOT_ISA
