#include "frozen_metric_binding.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <vector>

#include "frozen_metric.hpp"
#include "interior_point_binding.hpp"

namespace nb = nanobind;

namespace skyknot::inline SKYKNOT_ISA {
namespace {

using Globals = std::vector<double>;
using Places = nb::ndarray<const std::int64_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

struct BoundMetric {
    Bound& held;
    FrozenMetric metric;
    RowBuffer v, d;  // arguments, in rows

    BoundMetric(Bound& holder, const Tape& value, const Tape& full)
        : held(holder),
          metric(*holder.solver, value, full),
          v(holder.structure, holder.structure.v_rows()),
          d(holder.structure, holder.structure.interior()) {}

    int N() const { return held.structure.N; }
    nb::tuple gradient() const {
        return nb::make_tuple(table(metric.gradient, N() + 1), metric.gradient_q);
    }
    nb::object defect() const { return nb::cast(table(metric.defect, N())); }
};

void load_numbers(BoundMetric& self, const nb::dict& data) {
    skyknot::load(*self.held.solver, self.held.structure, data);
    self.metric.reload();
}

nb::tuple evaluate(BoundMetric& self, const Table& z, const Globals& q) {
    fill(self.metric.unknowns(), z), self.metric.globals() = q;
    const double objective = self.metric.evaluate();
    return nb::make_tuple(objective, self.defect());
}

nb::tuple differentiate(BoundMetric& self, const Table& z, const Globals& q, const Table& lambda) {
    fill(self.metric.unknowns(), z), self.metric.globals() = q;
    fill(self.d, lambda);
    const double objective = self.metric.differentiate(self.d);
    return nb::make_tuple(objective, self.defect(), self.gradient());
}

nb::tuple adjoint(BoundMetric& self, const Table& lambda) {
    fill(self.d, lambda);
    self.metric.adjoint(self.d);
    return self.gradient();
}

bool factor(BoundMetric& self, const Places& pins, const Table& weights, const Globals& weight_q,
            double delta) {
    fill(self.v, weights);
    std::vector<Pin> places;
    for (std::size_t i = 0; i < pins.shape(0); ++i)
        places.push_back({static_cast<int>(pins(i, 0)), static_cast<int>(pins(i, 1))});
    return self.metric.factor(places, self.v, weight_q, delta);
}

nb::tuple solve(BoundMetric& self, const Table& r, const Globals& r_q, const Table& d,
                int refinements) {
    fill(self.v, r), fill(self.d, d);
    self.metric.solve(self.v, r_q, self.d, refinements);
    const Direction& step = self.metric.step;
    return nb::make_tuple(table(step.v, self.N() + 1), step.q, table(step.lambda, self.N()),
                          step.pins);
}

nb::tuple product(BoundMetric& self, const Table& v, const Globals& q) {
    fill(self.v, v);
    self.metric.product(self.v, q);
    return nb::make_tuple(self.gradient(), self.defect());
}

}  // namespace

void bind_frozen_metric(nb::module_& module) {
    nb::class_<BoundMetric>(module, "FrozenMetric", "A Newton matrix frozen at one point.")
        .def(nb::init<Bound&, const Tape&, const Tape&>(), nb::keep_alive<1, 2>(),
             nb::keep_alive<1, 3>(), nb::keep_alive<1, 4>())
        .def("load", &load_numbers, "Bounds, scales and numbers of the points.")
        .def("evaluate", &evaluate, "(objective, defects) at (z, q).")
        .def("differentiate", &differentiate,
             "(objective, defects, gradient of the objective) at (z, q); Hessians with lambda.")
        .def("adjoint", &adjoint, "The defects' Jacobian transposed times lambda.")
        .def("freeze", [](BoundMetric& self) { self.metric.freeze(); },
             "Take matrix and Jacobian from the point last differentiated.")
        .def("factor", &factor, "Whether the matrix is definite where pins leave freedom.")
        .def("solve", &solve, "The step (v, q, lambda, pins) for a gradient and defects.")
        .def("product", &product, "Matrix and frozen Jacobian times a step.");
}

}  // namespace skyknot::inline SKYKNOT_ISA
