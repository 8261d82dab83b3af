// One Newton step with every weight and right-hand side given from outside, so that the linear
// algebra can be judged alone.
#include "newton_binding.hpp"

#include <nanobind/stl/vector.h>

#include <algorithm>
#include <vector>

#include "interior_point_binding.hpp"

namespace nb = nanobind;

namespace skyknot::inline SKYKNOT_ISA {
namespace {

template <class T>
T get(const nb::dict& from, const char* name) {
    return nb::cast<T>(from[name]);
}

// Lanes past the last segment evaluate a copy of it.
void repeat_last(const Structure& S, RowBuffer& z) {
    for (int r = 0; r < S.v_rows(); ++r)
        std::fill(z.row(r) + S.count(r), z.row(r) + z.stride() - Structure::front,
                  z.row(r)[S.count(r) - 1]);
}

// Derivatives at the loaded point and multipliers.
void differentiate(InteriorPoint& solver, const Structure& S) {
    std::vector<const RowBuffer*> y;
    for (const GroupState& group : solver.groups) y.push_back(&group.y);
    repeat_last(S, solver.z);
    solver.points.differentiate(solver.z, solver.q.data(), solver.lambda, y);
    solver.newton.evaluate_terminal(solver.z, solver.q.data(), solver.objective_scale);
}

void load_system(InteriorPoint& solver, const nb::dict& system) {
    Newton& newton = solver.newton;
    const auto equality_weight = get<double>(system, "equality_weight");
    newton.pins = solver.pins;
    newton.pin_weight = equality_weight;
    newton.regularisation = get<double>(system, "regularisation");
    newton.accuracy = get<double>(system, "accuracy");
    newton.weight_v.clear();
    fill(newton.weight_v, get<Table>(system, "weight_v"));
    newton.weight_q = get<std::vector<double>>(system, "weight_q");
    const auto weights = get<std::vector<Table>>(system, "row_weights");
    const auto residuals = get<std::vector<Table>>(system, "row_residuals");
    for (std::size_t g = 0; g < newton.groups.size(); ++g) {
        Group& group = newton.groups[g];
        group.weight.clear(), group.residual.clear(), group.equality.clear();
        fill(group.weight, weights[g]), fill(group.residual, residuals[g]);
        for (int i = 0; i < group.equality.rows(); ++i)
            for (int k = 0; k < solver.groups[g].count; ++k)
                group.equality.row(i)[k] =
                    equality_weight * solver.groups[g].equality.row(i)[k];
    }
}

// {"factored": bool} and, when it is, the step.
nb::dict newton_step(Bound& self, const nb::dict& data, const nb::dict& system) {
    InteriorPoint& solver = *self.solver;
    const Structure& S = self.structure;
    load(solver, S, data);
    load_multipliers(solver, S, data);
    differentiate(solver, S);
    load_system(solver, system);
    nb::dict result;
    const bool factored = solver.newton.factor();
    result["factored"] = factored;
    if (!factored) {
        result["failed_stage"] = solver.newton.riccati().failed_stage;
        return result;
    }
    RowBuffer r(S, S.v_rows()), d(S, S.interior());
    fill(r, get<Table>(system, "r")), fill(d, get<Table>(system, "d"));
    const auto r_q = get<std::vector<double>>(system, "r_q");
    Direction step = solver.newton.direction();
    result["residual"] =
        solver.newton.solve(r, r_q.data(), d, step, get<int>(system, "refinements"));
    result["v"] = table(step.v, S.N + 1), result["q"] = step.q;
    result["lambda"] = table(step.lambda, S.N);
    nb::list equality;
    for (std::size_t g = 0; g < step.equality.size(); ++g)
        equality.append(table(step.equality[g], solver.groups[g].count));
    result["equality"] = equality, result["pins"] = step.pins;
    return result;
}

}  // namespace

void bind_newton(nb::module_& module) {
    module.def("newton_step", &newton_step, nb::arg("solver"), nb::arg("data"), nb::arg("system"),
               "Factor and solve one Newton system at the point and multipliers of `data`.");
}

}  // namespace skyknot::inline SKYKNOT_ISA
