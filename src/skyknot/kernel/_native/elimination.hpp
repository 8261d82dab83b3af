// Interval elimination: the interior states of a segment leave, a stage of an optimal control
// problem remains. Works for every scheme whose rows read Σ C x + h Σ A F = 0.
//
// Rows are scaled so that row i has coefficient 1 on X_{i+1}: M X_I + N w + d = 0 with X_I the
// states of points 1 … s−1. Then X_I = T w + m, T = −M⁻¹N, m = −M⁻¹d, and the Hessian over y is
// projected by T. Multipliers come back from stationarity in X_I:
// Λ = −M⁻ᵀ (H δy + g)_I − M⁻ᵀ e_last π with π the gradient of the cost-to-go in x_{k+1}.
#pragma once

#include <cstdint>
#include <vector>

#include "micro_program.hpp"
#include "stage.hpp"
#include "structure.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// Sources and targets of the three programs, in the order of their pointer arrays.
namespace source {
enum : std::uint32_t {
    fixed,      // rows: segment length h, then one row a rate row: coefficient of the duration
    weight_v,   // V rows: Σ of the bounds (added to the Hessian's diagonal)
    weight_r,   // rate rows: weight D
    segment,    // what `factor` keeps for the others: M's factors, N, H
    gradient,   // V rows: g
    defect,     // D rows: d
    step,       // V rows: δ
    elastic,    // nx rows: δe
    costate,    // nx rows: π
    first_class // class rows, eight columns after eight; D weights of path rows follow each class
};
}
namespace target {
enum : std::uint32_t { segment, step, defect };
}
// Blocks of the stages: `factor` writes the first two, `reduce` its only one.
namespace block {
enum : std::uint32_t { stage, hessian };
enum : std::uint32_t { vector };
}
namespace scalar {
enum : std::uint32_t { regularisation, elastic_weight, first_global };
}

class Elimination {
public:
    Elimination(const Structure& structure, bool elastic);

    // `factor`: derivatives → segment rows; the stage's block, and its Hessian on and below the
    //     diagonal's blocks of eight.
    // `reduce`: gradient and defects → the stage's right-hand side.
    // `expand`: step of w and π → interior states and multipliers.
    MicroProgram factor, reduce, expand;
    std::size_t segment_rows = 0;

    // Places of each segment's share of the globals' gradient in the workspace, after `reduce`.
    std::vector<std::uint32_t> global_places;
};

}  // namespace skyknot::inline SKYKNOT_ISA
