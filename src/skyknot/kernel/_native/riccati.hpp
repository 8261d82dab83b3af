// Riccati recursion on the stages that elimination leaves.
//
// Legend: w = (v, s); x_{k+1} = A w + r, carried entries of s_{k+1} are entries of v;
// P, p: Hessian and gradient of the cost-to-go in s. At each stage
//     C = H + [A; carry]ᵀ P [A; carry] = [C_vv ·; C_sv C_ss],   C_vv = L Lᵀ,
//     P ← C_ss − C_sv C_vv⁻¹ C_vs.
// A C_vv that is not positive definite is the inertia test's answer: the step would not be a
// minimiser, and the Hessian must be regularised (Rao, Wright & Rawlings 1998).
#pragma once

#include <cstddef>
#include <vector>

#include "stage.hpp"
#include "structure.hpp"
#include "workspace.hpp"

namespace skyknot::inline SKYKNOT_ISA {

class Riccati {
public:
    Riccati(const Structure& structure, bool elastic);

    const StageLayout& layout() const { return layout_; }
    double* stage(int k) { return stages_.get() + static_cast<std::size_t>(k) * layout_.size(); }
    const double* stage(int k) const {
        return stages_.get() + static_cast<std::size_t>(k) * layout_.size();
    }
    // Hessian of stage k until `factor_stage(k)`; eight stages share the room.
    double* hessian(int k) {
        return hessians_.get() + static_cast<std::size_t>(k % 8) * layout_.hessian_size();
    }
    // Terminal Hessian, (sp, ns) column-major; filled by the caller before `factor`.
    double* terminal() { return P(N_); }
    // Columns of the first stage state that are fixed.
    std::vector<char> fixed_first;

    // Stages from last to first, then the first state. False when a pivot is not positive.
    bool factor_stage(int k);
    bool factor_first();
    int failed_stage = -1;  // set by the caller

    // One right-hand side: stage k at [k vector_size], and the terminal gradient (sp).
    struct RightSide {
        Workspace stages, terminal;
        Workspace p;       // (N + 1, sp), by `backward`
        Workspace y;       // (N, vp), by `backward`
        Workspace w;       // (N, wp) and s_N in (sp), by `forward`
        Workspace last;
        Workspace costate; // (N + 1, sp): P s + p, by `forward`
    };
    RightSide right_side() const;
    void backward(RightSide& right) const;
    void forward(RightSide& right) const;

    // Rows of the optimal policy v = −K s of stage k: its first `rows` entries in x_k, row-major.
    void policy(int k, int rows, double* K) const;
    // Hessian of the cost-to-go in s_k, (sp, ns) column-major.
    const double* cost_to_go(int k) const { return P(k); }

private:
    double* P(int k) { return P_.get() + static_cast<std::size_t>(k * layout_.sp * layout_.ns); }
    const double* P(int k) const {
        return P_.get() + static_cast<std::size_t>(k * layout_.sp * layout_.ns);
    }
    double* L(int k) { return L_.get() + static_cast<std::size_t>(k * layout_.wp * layout_.nv); }
    const double* L(int k) const {
        return L_.get() + static_cast<std::size_t>(k * layout_.wp * layout_.nv);
    }

    double* inverse(int k) { return inverse_.get() + static_cast<std::size_t>(8 * k * layout_.vp); }
    const double* inverse(int k) const {
        return inverse_.get() + static_cast<std::size_t>(8 * k * layout_.vp);
    }

    Structure structure_;
    StageLayout layout_;
    int N_;
    Workspace stages_, hessians_, P_, L_;
    Workspace inverse_;  // L⁻¹ of the diagonal blocks of eight, row-major, (N, vp, 8)
    Workspace carry_;    // rows of w that the next stage state carries over, (ns − nx, wp)
    Workspace M_;
    std::vector<double> first_;           // Cholesky factor over the free part of s_0
    std::vector<int> free_;
};

}  // namespace skyknot::inline SKYKNOT_ISA
