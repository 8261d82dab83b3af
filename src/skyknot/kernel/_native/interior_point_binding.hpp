// The interior point as Python sees it, and how rows cross the border.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <memory>

#include "interior_point.hpp"

namespace skyknot::inline SKYKNOT_ISA {

using Table = nanobind::ndarray<const double, nanobind::ndim<2>, nanobind::c_contig,
                                nanobind::device::cpu>;
using Written = nanobind::ndarray<nanobind::numpy, double, nanobind::ndim<2>, nanobind::c_contig>;

// Where the program's unknowns but for the globals stand in rows of N + 1: the entry of each.
using Places = nanobind::ndarray<const std::int64_t, nanobind::ndim<1>, nanobind::c_contig,
                                 nanobind::device::cpu>;

struct Bound {
    Structure structure;
    std::vector<std::size_t> places;
    std::unique_ptr<InteriorPoint> solver;
};

// Bounds, start and scales; then multipliers, as kernel/rows.py packs them.
void load(InteriorPoint& solver, const Structure& S, const nanobind::dict& data);
void load_multipliers(InteriorPoint& solver, const Structure& S, const nanobind::dict& data);

void fill(RowBuffer& rows, const Table& values);
Written table(const RowBuffer& rows, int columns);

void bind_interior_point(nanobind::module_& module);

}  // namespace skyknot::inline SKYKNOT_ISA
