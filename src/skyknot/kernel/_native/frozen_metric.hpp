// A metric for gradient projection: a Newton matrix frozen at one point, used at many.
//
//     M = ∇²(J + λᵀc) + δ,   J₀ = ∇c     at the point and multipliers of `freeze`
//
// λ = 0 gives the Gauss–Newton metric, the Hessian of the cost alone. Values and slopes at other
// points come from a second set of evaluated points, so that the factorisation stays as it is.
#pragma once

#include <vector>

#include "interior_point.hpp"

namespace skyknot::inline SKYKNOT_ISA {

class FrozenMetric {
public:
    // `held` lends its Newton system and its evaluated points, which become the frozen ones.
    FrozenMetric(InteriorPoint& held, const Tape& value, const Tape& full);

    // Reads again what the interior point was loaded with.
    void reload();
    RowBuffer& unknowns() { return z_; }
    std::vector<double>& globals() { return q_; }
    // Objective at the unknowns; defects in `defect`.
    double evaluate();
    // The same with slopes; ∇J in `gradient` and `gradient_q`, Hessians taken with λ.
    double differentiate(const RowBuffer& lambda);
    // ∇cᵀ λ at the point last differentiated, in `gradient` and `gradient_q`.
    void adjoint(const RowBuffer& lambda);
    // Makes the point last differentiated the frozen one.
    void freeze();
    // False when M + diag(weights) is not positive definite where constraints and pins leave
    // freedom. `weights` are rows of unknowns.
    bool factor(const std::vector<Pin>& pins, const RowBuffer& weights,
                const std::vector<double>& weight_q, double delta);
    // [M ∇cᵀ; ∇c 0] (δ, λ) = −(right, defect) with pins at zero, into `step`.
    void solve(const RowBuffer& right, const std::vector<double>& right_q, const RowBuffer& d,
               int refinements);
    // M v, without the weights, in `gradient` and `gradient_q`, J₀ v in `defect`.
    void product(const RowBuffer& v, const std::vector<double>& q);

    RowBuffer gradient, defect;
    std::vector<double> gradient_q;
    Direction step;

private:
    void repeat_last();
    void evaluate_terminal();

    InteriorPoint& held_;
    Structure S_;
    Points current_;
    RowBuffer z_, nothing_, no_multipliers_, path_;  // the second and third stay zero
    std::vector<double> q_;
    std::vector<BlockRows> rates_;
    Workspace terminal_workspace_;
    double terminal_value_ = 0.0;
    std::vector<double> terminal_gradient_, terminal_hessian_, frozen_hessian_;
};

}  // namespace skyknot::inline SKYKNOT_ISA
