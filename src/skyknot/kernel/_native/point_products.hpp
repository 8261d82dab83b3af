// Sparse products of what the tape returned at eight points, H, ∂F and ∂g, with vectors there.
//
// Recorded once from the sparsity pattern, like the elimination; sums stay in registers.
#pragma once

#include <cstdint>
#include <vector>

#include "micro_program.hpp"
#include "structure.hpp"
#include "workspace.hpp"

namespace skyknot::inline SKYKNOT_ISA {

class PointProducts {
public:
    // Which of the two sides of ∂F and ∂g, and the Hessian, take part.
    enum class Of { step, adjoint, path_step, path_adjoint };
    //  step:         out = H y + ∂Fᵀ ν + ∂gᵀ (D ∂g y + t), rates = ∂F y, path = ∂g y
    //  adjoint:      out = ∂Fᵀ ν + ∂gᵀ t
    //  path_step:    path = ∂g y
    //  path_adjoint: out = ∂gᵀ t
    PointProducts(const Structure& structure, Of what);

    // Written by the caller, eight doubles a row: y (x, u, q), ν, t and D.
    double* y() { return workspace_.get() + y_; }
    double* nu() { return workspace_.get() + nu_; }
    double* t() { return workspace_.get() + t_; }
    double* weight() { return workspace_.get() + weight_; }
    // `class_rows`: of the eight points.
    void run(const double* class_rows) {
        program_.run({.sources = &class_rows, .workspace = workspace_.get()});
    }
    // Row i of the results; zeros where there is structurally nothing.
    const double* out(int i) const { return result(out_, i); }
    const double* rates(int i) const { return result(rates_, i); }
    const double* path(int i) const { return result(path_, i); }

private:
    const double* result(const std::vector<std::uint32_t>& places, int i) const {
        return workspace_.get() + places[static_cast<std::size_t>(i)];
    }

    MicroProgram program_;
    std::uint32_t y_ = 0, nu_ = 0, t_ = 0, weight_ = 0;
    std::vector<std::uint32_t> out_, rates_, path_;
    Workspace workspace_;
};

}  // namespace skyknot::inline SKYKNOT_ISA
