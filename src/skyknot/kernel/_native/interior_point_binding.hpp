// The interior point as Python sees it, and how rows cross the border.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <memory>

#include "interior_point.hpp"

namespace skyknot::inline SKYKNOT_ISA {

using Table = nanobind::ndarray<const double, nanobind::ndim<2>, nanobind::c_contig,
                                nanobind::device::cpu>;
using Written = nanobind::ndarray<nanobind::numpy, double, nanobind::ndim<2>, nanobind::c_contig>;

struct Bound {
    Structure structure;
    std::unique_ptr<InteriorPoint> solver;
};

// Bounds, start and scales; then multipliers, as kernel/rows.py packs them.
void load(InteriorPoint& solver, const Structure& S, const nanobind::dict& data);
void load_multipliers(InteriorPoint& solver, const Structure& S, const nanobind::dict& data);

void fill(RowBuffer& rows, const Table& values);
Written table(const RowBuffer& rows, int columns);

void bind_interior_point(nanobind::module_& module);

}  // namespace skyknot::inline SKYKNOT_ISA
