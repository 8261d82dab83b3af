// Where a stage's matrices stand: contiguous blocks, columns padded to eight.
//
// Legend: w = [v | padding | s | padding] is the stage vector, A the (nx, w) map to x_{k+1}, H the
// Hessian over w, r the constant of the map, g the gradient; a suffix q is for the globals.
#pragma once

#include <cstddef>

#include "structure.hpp"
#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {

struct StageLayout {
    int nx, nq, ns, nv;
    int vp, sp, wp;  // padded sizes of v, s and w

    StageLayout(const Structure& structure, bool elastic)
        : nx(structure.nx),
          nq(structure.nq),
          ns(structure.ns()),
          nv(structure.nv(elastic)),
          vp(padded8(nv)),
          sp(padded8(ns)),
          wp(vp + sp) {}

    int v(int i) const { return i; }
    int s(int i) const { return vp + i; }

    // Offsets in the block kept for every stage, in doubles.
    std::size_t A(int row, int w) const { return at(row * wp + w); }
    std::size_t rq(int row, int q) const { return at(nx * wp + q * padded8(nx) + row); }
    std::size_t gq(int w, int q) const { return at(nx * wp + nq * padded8(nx) + q * wp + w); }
    std::size_t Hqq(int a, int b) const {
        return at(nx * wp + nq * (padded8(nx) + wp) + a * nq + b);
    }
    std::size_t size() const { return at(padded8(nx * wp + nq * (padded8(nx) + wp) + nq * nq)); }
    // Offset in the Hessian, which lives only until its stage is factored.
    std::size_t H(int row, int column) const { return at(column * wp + row); }
    std::size_t hessian_size() const { return at(wp * wp); }
    // A stage's right-hand side: [g over w | r].
    std::size_t g(int w) const { return at(w); }
    std::size_t r(int row) const { return at(wp + row); }
    std::size_t vector_size() const { return at(wp + padded8(nx)); }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
};

}  // namespace skyknot::inline SKYKNOT_ISA
