// Sparse linear systems of one pattern, solved eight at a time as a segment's are.
#include "micro_program_binding.hpp"

#include <nanobind/ndarray.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "sparse_lu.hpp"
#include "workspace.hpp"

namespace nb = nanobind;

namespace skyknot::inline SKYKNOT_ISA {
namespace {

// (n, n, 8): entry, entry, lane; zero in every lane means structurally zero.
using Matrices = nb::ndarray<const double, nb::shape<-1, -1, lane_count>, nb::c_contig,
                             nb::device::cpu>;
using Vectors = nb::ndarray<const double, nb::shape<-1, lane_count>, nb::c_contig, nb::device::cpu>;

bool present(const Matrices& M, std::size_t entry) {
    for (std::size_t lane = 0; lane < lane_count; ++lane)
        if (M.data()[entry * lane_count + lane] != 0.0) return true;
    return false;
}

std::pair<nb::ndarray<nb::numpy, double>, std::size_t> solve_lanes(const Matrices& M,
                                                                   const Vectors& right,
                                                                   bool transposed) {
    const std::size_t n = M.shape(0);
    if (M.shape(1) != n || right.shape(0) != n)
        throw std::invalid_argument("matrices (n, n, 8) and right-hand sides (n, 8) expected");
    Builder builder(lane_count);
    Matrix entries = zeros(static_cast<int>(n), static_cast<int>(n));
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            if (present(M, i * n + j)) entries[i][j] = builder.input(0, i * n + j);
    std::vector<Value> x(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = builder.input(1, i);
    const Factors factors = factorise(builder, std::move(entries));
    x = transposed ? solve_transposed(builder, factors, std::move(x))
                   : solve(builder, factors, std::move(x));
    for (std::size_t i = 0; i < n; ++i) builder.output(0, i * lane_count, x[i]);
    const MicroProgram program = builder.finish();
    const Workspace workspace = make_workspace(lane_count * program.slots());
    auto* memory = new double[n * lane_count]{};
    const nb::capsule owner(memory, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    const double* const sources[] = {M.data(), right.data()};
    double* const targets[] = {memory};
    program.run({.sources = sources, .targets = targets, .workspace = workspace.get()});
    return {nb::ndarray<nb::numpy, double>(memory, {n, lane_count}, owner),
            program.multiplications()};
}

}  // namespace

void bind_micro_program(nb::module_& module) {
    module.def(
        "solve_lanes",
        [](const Matrices& M, const Vectors& right, bool transposed) {
            const auto [x, multiplications] = solve_lanes(M, right, transposed);
            return nb::make_tuple(x, multiplications);
        },
        nb::arg("M"), nb::arg("right"), nb::arg("transposed") = false,
        "Solve eight systems of one pattern: solutions (n, 8), and multiply-adds of a lane.");
}

}  // namespace skyknot::inline SKYKNOT_ISA
