#include "frozen_metric.hpp"

#include <algorithm>

#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

FrozenMetric::FrozenMetric(InteriorPoint& held, const Tape& value, const Tape& full)
    : gradient(held.points.structure(), held.points.structure().v_rows()),
      defect(held.points.structure(), held.points.structure().interior()),
      gradient_q(at(held.points.structure().nq)),
      step(held.newton.direction()),
      held_(held),
      S_(held.points.structure()),
      current_(S_, value, full),
      z_(S_, S_.v_rows()),
      nothing_(S_, S_.ng),
      no_multipliers_(S_, S_.interior()),
      path_(S_, S_.ng),
      q_(at(S_.nq)),
      terminal_workspace_(make_workspace(held.newton.terminal_tape().workspace_size(8))),
      terminal_gradient_(at(S_.nx + S_.nq)),
      terminal_hessian_(at((S_.nx + S_.nq) * (S_.nx + S_.nq))),
      frozen_hessian_(terminal_hessian_.size()) {
    for (int c = 0; c < S_.classes(); ++c) rates_.emplace_back(S_, S_.nx);
    held_.newton.terminal_tape().prepare<8>(terminal_workspace_.get());
    // steps of a gradient projection are not corrected by later ones as Newton's are
    held_.newton.accuracy = 1e-10;
}

void FrozenMetric::reload() {
    for (int c = 0; c < S_.classes(); ++c) {
        current_.time[at(c)].copy(held_.points.time[at(c)]);
        current_.cost[at(c)].copy(held_.points.cost[at(c)]);
    }
    current_.length.copy(held_.points.length);
    current_.parameters = held_.points.parameters;
}

// Lanes past the last segment evaluate a copy of it.
void FrozenMetric::repeat_last() {
    for (int r = 0; r < S_.v_rows(); ++r)
        std::fill(z_.row(r) + S_.count(r), z_.row(r) + z_.stride() - Structure::front,
                  z_.row(r)[S_.count(r) - 1]);
}

// The terminal tape reads (x, q, p) and gives M, its gradient over (x, q) and its dense Hessian.
void FrozenMetric::evaluate_terminal() {
    const Tape& tape = held_.newton.terminal_tape();
    double* w = terminal_workspace_.get();
    const int n = S_.nx + S_.nq;
    for (int i = 0; i < n; ++i)
        store8(w + 8 * i, broadcast8(i < S_.nx ? z_.row(S_.state_row(0, i))[S_.N]
                                               : q_[at(i - S_.nx)]));
    for (int i = 0; i < S_.np; ++i) store8(w + 8 * (n + i), broadcast8(current_.parameters[at(i)]));
    tape.run<8>(w);
    const auto read = [&](int o) {
        return held_.objective_scale * w[tape.output_slot(at(o)) * 8];
    };
    terminal_value_ = read(0);
    for (int i = 0; i < n; ++i) terminal_gradient_[at(i)] = read(1 + i);
    for (int i = 0; i < n * n; ++i) terminal_hessian_[at(i)] = read(1 + n + i);
}

double FrozenMetric::evaluate() {
    repeat_last();
    current_.evaluate(z_, q_.data());
    current_.defects(z_, defect);
    evaluate_terminal();
    return current_.cost_sum() + terminal_value_;
}

double FrozenMetric::differentiate(const RowBuffer& lambda) {
    repeat_last();
    const std::vector<const RowBuffer*> y(at(S_.classes()), &nothing_);
    current_.differentiate(z_, q_.data(), lambda, y);
    current_.defects(z_, defect);
    evaluate_terminal();
    gradient.clear();
    std::fill(gradient_q.begin(), gradient_q.end(), 0.0);
    current_.add_cost_gradient(gradient, gradient_q.data());
    for (int i = 0; i < S_.nx; ++i) gradient.row(i)[S_.N] += terminal_gradient_[at(i)];
    for (int i = 0; i < S_.nq; ++i) gradient_q[at(i)] += terminal_gradient_[at(S_.nx + i)];
    return current_.cost_sum() + terminal_value_;
}

void FrozenMetric::adjoint(const RowBuffer& lambda) {
    gradient.clear();
    std::fill(gradient_q.begin(), gradient_q.end(), 0.0);
    current_.add_adjoint(lambda, {}, gradient, gradient_q.data());
}

void FrozenMetric::freeze() {
    for (int c = 0; c < S_.classes(); ++c)
        held_.points.rows[at(c)].copy(current_.rows[at(c)]);
    held_.newton.evaluate_terminal(z_, q_.data(), held_.objective_scale);
    frozen_hessian_ = terminal_hessian_;
}

bool FrozenMetric::factor(const std::vector<Pin>& pins, const RowBuffer& weights,
                          const std::vector<double>& weight_q, double delta) {
    Newton& newton = held_.newton;
    newton.pins = pins;
    newton.pin_weight = 1e8;
    newton.regularisation = delta;
    newton.weight_v.copy(weights);
    newton.weight_q = weight_q;
    for (Group& group : newton.groups)
        group.weight.clear(), group.residual.clear(), group.equality.clear();
    step = newton.direction();
    return newton.factor();
}

void FrozenMetric::solve(const RowBuffer& right, const std::vector<double>& right_q,
                         const RowBuffer& d, int refinements) {
    held_.newton.solve(right, right_q.data(), d, step, refinements);
}

void FrozenMetric::product(const RowBuffer& v, const std::vector<double>& q) {
    gradient.clear();
    std::fill(gradient_q.begin(), gradient_q.end(), 0.0);
    for (int c = 0; c < S_.classes(); ++c)
        held_.points.add_products(c, v, q.data(), no_multipliers_, {nothing_, nothing_, path_},
                                  rates_[at(c)], gradient, gradient_q.data());
    held_.points.combine(v, rates_, 0, nullptr, defect);
    const double delta = held_.newton.regularisation;
    for (int row = 0; row < S_.v_rows(); ++row)
        for (int k = 0; k < S_.count(row); ++k) gradient.row(row)[k] += delta * v.row(row)[k];
    const int n = S_.nx + S_.nq;
    const auto entry = [&](int i) { return i < S_.nx ? v.row(i)[S_.N] : q[at(i - S_.nx)]; };
    for (int i = 0; i < n; ++i) {
        double& to = i < S_.nx ? gradient.row(i)[S_.N] : gradient_q[at(i - S_.nx)];
        for (int j = 0; j < n; ++j) to += frozen_hessian_[at(i * n + j)] * entry(j);
    }
    for (int i = 0; i < S_.nq; ++i)
        gradient_q[at(i)] += delta * q[at(i)];
}

}  // namespace skyknot::inline SKYKNOT_ISA
