// Filter line search with second-order correction, sections 2.3 and 2.4 of the paper.
#include <cmath>

#include "interior_point.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

constexpr double gamma_theta = 1e-5, gamma_phi = 1e-8, eta_phi = 1e-8, gamma_alpha = 0.05;
constexpr double s_theta = 1.1, s_phi = 2.3, kappa_soc = 0.99;
constexpr int corrections = 4, most_tiny_steps = 4;
constexpr double rounding = 10.0 * 2.220446049250313e-16;

}  // namespace

double InteriorPoint::slope() const {
    double sum = 0.0;
    for (int r = 0; r < S_.v_rows(); ++r) {
        const double *g = cost_gradient_.row(r), *step = direction_.v.row(r);
        sum += total(S_.count(r), [=](auto read) SKYKNOT_LAMBDA { return read(g) * read(step); });
    }
    for (std::size_t i = 0; i < q.size(); ++i) sum += q_cost_[i] * direction_.q[i];
    for (const Bounded& b : bounded_) sum += b.box.barrier_slope(barrier);
    return sum;
}

double InteriorPoint::longest_primal(double tau) const {
    double alpha = 1.0;
    for (const Bounded& b : bounded_) alpha = b.box.longest_primal(tau, alpha);
    return alpha;
}

void InteriorPoint::make_trial(double alpha) {
    for (int r = 0; r < S_.v_rows(); ++r) {
        const double *from = z.row(r), *step = direction_.v.row(r);
        double* to = trial_z_.row(r);
        for (int k = 0; k < S_.count(r); ++k) to[k] = from[k] + alpha * step[k];
    }
    repeat_last(trial_z_);
    for (std::size_t i = 0; i < q.size(); ++i) trial_q_[i] = q[i] + alpha * direction_.q[i];
    for (GroupState& group : groups)
        for (int i = 0; i < group.slack.rows(); ++i)
            for (int k = 0; k < group.count; ++k)
                group.trial_slack.row(i)[k] =
                    group.slack.row(i)[k] + alpha * group.slack_step.row(i)[k];
}

// The filter's verdict on a trial point; sets whether the filter must grow.
bool InteriorPoint::accept(const Merit& trial, double alpha, double descent) {
    if (!std::isfinite(trial.phi) || !filter_.accepts(trial.theta, trial.phi)) return false;
    const double slack = rounding * (1.0 + std::abs(now_.phi));
    const double theta_small = 1e-4 * std::max(1.0, theta_start_);
    const bool switching = descent < 0.0 && alpha * std::pow(-descent, s_phi) >
                                                std::pow(now_.theta, s_theta);
    if (switching && now_.theta <= theta_small) {
        augment_ = false;
        return trial.phi <= now_.phi + eta_phi * alpha * descent + slack;
    }
    augment_ = true;
    return trial.theta <= (1.0 - gamma_theta) * now_.theta ||
           trial.phi <= now_.phi - gamma_phi * now_.theta + slack;
}

// Largest |δz| relative to 1 + |z|.
double InteriorPoint::relative_step() const {
    double most = 0.0;
    for (int r = 0; r < S_.v_rows(); ++r) {
        const double *step = direction_.v.row(r), *at = z.row(r);
        most = largest(S_.count(r), most, [=](auto read) SKYKNOT_LAMBDA {
            return absolute(read(step)) / (1.0 + absolute(read(at)));
        });
    }
    for (std::size_t i = 0; i < q.size(); ++i)
        most = std::max(most, std::abs(direction_.q[i]) / (1.0 + std::abs(q[i])));
    return most;
}

// Section 3.9: rounding would decide on a step that is nothing but rounding; take it in full, so
// that the multipliers move, but not for ever.
bool InteriorPoint::take_tiny_step(double alpha) {
    tiny_steps_ = relative_step() < rounding ? tiny_steps_ + 1 : 0;
    if (tiny_steps_ == 0 || tiny_steps_ > most_tiny_steps) return false;
    make_trial(alpha_ = alpha);
    return evaluate(trial_z_, trial_q_.data(), true);
}

bool InteriorPoint::line_search(double tau) {
    const double descent = slope();
    const double alpha_max = longest_primal(tau);
    alpha_dual_ = 1.0;
    for (const Bounded& b : bounded_) alpha_dual_ = b.box.longest_dual(tau, alpha_dual_);
    if (take_tiny_step(alpha_max)) return true;
    double alpha_min = gamma_theta;
    if (descent < 0.0) {
        alpha_min = std::min(alpha_min, gamma_phi * now_.theta / -descent);
        if (now_.theta <= 1e-4 * std::max(1.0, theta_start_))
            alpha_min = std::min(alpha_min,
                                 std::pow(now_.theta, s_theta) / std::pow(-descent, s_phi));
    }
    alpha_min *= gamma_alpha;
    alpha_min = std::max(alpha_min, 1e-13);
    bool first = true;
    for (double alpha = alpha_max; alpha >= alpha_min; alpha *= 0.5, first = false) {
        make_trial(alpha);
        alpha_ = alpha;
        const bool finite = evaluate(trial_z_, trial_q_.data(), true);
        const Merit& trial = trial_merit_;
        if (finite && accept(trial, alpha, descent)) {
            if (augment_) filter_.add(now_.theta, now_.phi);
            return true;
        }
        if (first && finite && trial.theta >= now_.theta &&
            second_order_correction(tau, descent)) {
            if (augment_) filter_.add(now_.theta, now_.phi);
            return true;
        }
    }
    return false;
}

// Steps that also remove the constraints' curvature, from the same factorisation.
bool InteriorPoint::second_order_correction(double tau, double descent) {
    const double alpha_first = alpha_, dual_first = alpha_dual_;
    double theta_before = now_.theta;
    used_defect_.copy(defect_);
    defect_in_use_ = &used_defect_;
    for (int attempt = 0; attempt < corrections; ++attempt) {
        for (int i = 0; i < used_defect_.rows(); ++i)
            for (int k = 0; k < S_.N; ++k)
                used_defect_.row(i)[k] =
                    alpha_ * used_defect_.row(i)[k] + trial_defect_.row(i)[k];
        for (std::size_t g = 0; g < groups.size(); ++g)
            for (int i = 0; i < groups[g].value.rows(); ++i)
                for (int k = 0; k < groups[g].count; ++k)
                    used_rows_[g].row(i)[k] = alpha_ * used_rows_[g].row(i)[k] +
                                              row_residual(g, i, k, true);
        solve_step();
        alpha_ = longest_primal(tau);
        make_trial(alpha_);
        if (!evaluate(trial_z_, trial_q_.data(), true)) break;
        const Merit& trial = trial_merit_;
        if (accept(trial, alpha_first, descent)) {
            alpha_dual_ = 1.0;
            for (const Bounded& b : bounded_) alpha_dual_ = b.box.longest_dual(tau, alpha_dual_);
            return true;
        }
        if (trial.theta > kappa_soc * theta_before) break;
        theta_before = trial.theta;
    }
    assemble(barrier);  // back to the plain step
    solve_step();
    alpha_ = alpha_first, alpha_dual_ = dual_first;
    return false;
}

}  // namespace skyknot::inline SKYKNOT_ISA
