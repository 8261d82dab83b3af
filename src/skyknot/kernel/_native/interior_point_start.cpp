// Where the interior point starts: boxes, a point inside them, multipliers (sections 3.3 and 3.6).
#include <cmath>

#include "interior_point.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

constexpr double equality_weight = 1e10;

}  // namespace

void InteriorPoint::prepare_boxes() {
    bounded_.clear();
    row_bounded_.assign(at(S_.v_rows()), 0);
    has_rows_ = false;
    for (const GroupState& group : groups) has_rows_ = has_rows_ || group.value.rows() > 0;
    const auto any_finite = [](const double* l, const double* u, int count) {
        for (int k = 0; k < count; ++k)
            if (std::isfinite(l[k]) || std::isfinite(u[k])) return true;
        return false;
    };
    for (int r = 0; r < S_.v_rows(); ++r)
        if (any_finite(lower.row(r), upper.row(r), S_.count(r))) {
            row_bounded_[at(r)] = 1;
            bounded_.push_back({{z.row(r), direction_.v.row(r), lower.row(r), upper.row(r),
                                 zl.row(r), zu.row(r), dzl_.row(r), dzu_.row(r), S_.count(r)},
                                trial_z_.row(r), newton.weight_v.row(r), right_.row(r)});
        }
    for (std::size_t i = 0; i < q.size(); ++i)
        bounded_.push_back({{&q[i], &direction_.q[i], &q_lower[i], &q_upper[i], &q_zl[i], &q_zu[i],
                             &dq_zl_[i], &dq_zu_[i], 1},
                            &trial_q_[i], &newton.weight_q[i], &q_right_[i]});
    variables_bounded_ = bounded_.size();
    for (std::size_t g = 0; g < groups.size(); ++g) {
        GroupState& group = groups[g];
        for (int r = 0; r < group.value.rows(); ++r)
            if (any_finite(group.lower.row(r), group.upper.row(r), group.count))
                bounded_.push_back(
                    {{group.slack.row(r), group.slack_step.row(r), group.lower.row(r),
                      group.upper.row(r), group.zl.row(r), group.zu.row(r), group.dzl.row(r),
                      group.dzu.row(r), group.count},
                     group.trial_slack.row(r), newton.groups[g].weight.row(r),
                     group.r_slack.row(r)});
    }
}

bool InteriorPoint::initialise(const Settings& settings) {
    newton.pins = pins;
    newton.pin_weight = equality_weight;
    direction_.pins.assign(pins.size(), 0.0);
    y_.clear();
    for (std::size_t c = 0; c < groups.size(); ++c) {
        y_.push_back(&groups[c].y);
        for (int i = 0; i < groups[c].value.rows(); ++i)
            for (int k = 0; k < groups[c].count; ++k)
                newton.groups[c].equality.row(i)[k] =
                    equality_weight * groups[c].equality.row(i)[k];
    }
    prepare_boxes();
    barrier = settings.barrier_start;
    last_regularisation_ = newton.regularisation = alpha_ = alpha_dual_ = 0.0;
    history.clear();
    for (Bounded& b : bounded_) b.box.push_inside(settings.push, settings.push);
    repeat_last(z);
    if (!evaluate(z, q.data(), false)) return false;
    for (GroupState& group : groups)
        for (int i = 0; i < group.value.rows(); ++i)
            for (int k = 0; k < group.count; ++k)
                if (group.equality.row(i)[k] == 0.0) group.slack.row(i)[k] = group.value.row(i)[k];
    for (Bounded& b : bounded_) {
        b.box.push_inside(settings.push, settings.push);
        if (!settings.warm) b.box.reset_multipliers(1.0);
    }
    if (!settings.warm) estimate_multipliers();
    now_ = merit(false);
    theta_start_ = now_.theta;
    filter_.reset(1e4 * std::max(1.0, theta_start_));
    return true;
}

// Least-squares multipliers, (36) of the paper: the Newton system with H = I.
void InteriorPoint::estimate_multipliers() {
    lambda.clear();
    for (GroupState& group : groups) group.y.clear();
    differentiate();
    gradients();
    points.clear_hessian();
    newton.weight_v.clear();
    std::fill(newton.weight_q.begin(), newton.weight_q.end(), 0.0);
    right_.copy(lagrangian_);
    q_right_ = q_lagrangian_;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        newton.groups[g].residual.clear();
        for (int i = 0; i < groups[g].value.rows(); ++i)
            for (int k = 0; k < groups[g].count; ++k)
                newton.groups[g].weight.row(i)[k] =
                    groups[g].active.row(i)[k] * (1.0 - groups[g].equality.row(i)[k]);
    }
    for (Bounded& b : bounded_)
        if (b.gradient >= right_.origin() && b.gradient < right_.origin() + right_.size())
            b.box.add_multipliers(b.gradient);
    used_defect_.clear();
    newton.regularisation = 1.0;
    const bool factored = newton.factor();
    if (factored) newton.solve(right_, q_right_.data(), used_defect_, direction_, 0);
    newton.regularisation = 0.0;
    if (!factored) return;
    double most = 0.0;
    for (int i = 0; i < lambda.rows(); ++i)
        for (int k = 0; k < S_.N; ++k) most = std::max(most, std::abs(direction_.lambda.row(i)[k]));
    if (most < 1e3) lambda.copy(direction_.lambda);
    if (!std::isfinite(most)) lambda.clear();
}

}  // namespace skyknot::inline SKYKNOT_ISA
