#include "interior_point_binding.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <memory>
#include <vector>

#include "interior_point.hpp"

namespace nb = nanobind;

namespace skyknot::inline SKYKNOT_ISA {
namespace {

template <class T>
T get(const nb::dict& from, const char* name) {
    return nb::cast<T>(from[name]);
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Nonzeros nonzeros(const nb::dict& from, const char* rows, const char* columns) {
    return {get<std::vector<int>>(from, rows), get<std::vector<int>>(from, columns)};
}

Structure structure_of(const nb::dict& d) {
    Structure S;
    S.nx = get<int>(d, "nx"), S.nu = get<int>(d, "nu"), S.nq = get<int>(d, "nq");
    S.ng = get<int>(d, "ng"), S.np = get<int>(d, "np"), S.N = get<int>(d, "N");
    S.s = get<int>(d, "s"), S.m = get<int>(d, "m");
    S.shared = get<bool>(d, "shared"), S.carry = get<bool>(d, "carry");
    S.free_duration = get<bool>(d, "free_duration");
    S.used = get<std::vector<int>>(d, "used");
    S.C = get<std::vector<double>>(d, "C"), S.A = get<std::vector<double>>(d, "A");
    S.W = get<std::vector<double>>(d, "W");
    S.gradient = get<std::vector<int>>(d, "gradient");
    S.JF = nonzeros(d, "JF_row", "JF_column");
    S.Jg = nonzeros(d, "Jg_row", "Jg_column");
    S.H = nonzeros(d, "H_row", "H_column");
    const auto controls = get<std::vector<int>>(d, "rate_control");
    const auto weights = get<std::vector<std::vector<double>>>(d, "rate_weights");
    for (std::size_t i = 0; i < controls.size(); ++i) S.rates.push_back({controls[i], weights[i]});
    return S;
}

}  // namespace

void fill(RowBuffer& rows, const Table& values) {
    for (std::size_t i = 0; i < values.shape(0); ++i)
        std::copy_n(values.data() + i * values.shape(1), values.shape(1),
                    rows.row(static_cast<int>(i)));
}

namespace {
void fill(RowBuffer& rows, const nb::dict& from, const char* name) {
    skyknot::fill(rows, get<Table>(from, name));
}

Written rows_of(int count, int size, double*& memory) {
    memory = new double[at(std::max(1, count * size))];
    const nb::capsule owner(memory, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    return Written(memory, {at(count), at(size)}, owner);
}

}  // namespace

Written table(const RowBuffer& rows, int columns) {
    double* to = nullptr;
    Written written = rows_of(rows.rows(), columns, to);
    for (int i = 0; i < rows.rows(); ++i) std::copy_n(rows.row(i), columns, to + i * columns);
    return written;
}

namespace {

// Infinite bounds become equality marks, masks and boxes.
void fill_group(GroupState& group, const Table& lower, const Table& upper,
                const std::vector<double>& unscale) {
    fill(group.lower, lower), fill(group.upper, upper);
    group.unscale = unscale;
    for (int i = 0; i < group.lower.rows(); ++i)
        for (int k = 0; k < group.count; ++k) {
            double &low = group.lower.row(i)[k], &high = group.upper.row(i)[k];
            group.active.row(i)[k] = std::isfinite(low) || std::isfinite(high) ? 1.0 : 0.0;
            group.equality.row(i)[k] = low == high ? 1.0 : 0.0;
            if (low == high) group.slack.row(i)[k] = low, low = -INFINITY, high = INFINITY;
        }
}

}  // namespace

void load(InteriorPoint& solver, const Structure& S, const nb::dict& d) {
    fill(solver.z, d, "z"), fill(solver.lower, d, "lower"), fill(solver.upper, d, "upper");
    fill(solver.scale, d, "scale");
    solver.q = get<std::vector<double>>(d, "q");
    solver.q_lower = get<std::vector<double>>(d, "q_lower");
    solver.q_upper = get<std::vector<double>>(d, "q_upper");
    solver.q_scale = get<std::vector<double>>(d, "q_scale");
    solver.defect_scale = get<std::vector<double>>(d, "defect_scale");
    solver.objective_scale = get<double>(d, "objective_scale");
    fill(solver.points.length, d, "length");
    solver.points.parameters = get<std::vector<double>>(d, "parameters");
    const auto times = get<std::vector<Table>>(d, "time"), costs = get<std::vector<Table>>(d, "cost");
    const auto lower = get<std::vector<Table>>(d, "path_lower");
    const auto upper = get<std::vector<Table>>(d, "path_upper");
    const auto unscale = get<std::vector<double>>(d, "path_unscale");
    for (int c = 0; c < S.classes(); ++c) {
        fill(solver.points.time[at(c)], times[at(c)]);
        fill(solver.points.cost[at(c)], costs[at(c)]);
        fill_group(solver.groups[at(c)], lower[at(c)], upper[at(c)], unscale);
    }
    fill_group(solver.groups.back(), get<Table>(d, "rate_lower"), get<Table>(d, "rate_upper"),
               get<std::vector<double>>(d, "rate_unscale"));
    solver.pins.clear();
    const auto rows = get<std::vector<int>>(d, "pin_row"), places = get<std::vector<int>>(d, "pin_k");
    for (std::size_t i = 0; i < rows.size(); ++i) solver.pins.push_back({rows[i], places[i]});
    solver.pin_multipliers.assign(rows.size(), 0.0);
    const auto fixed = get<std::vector<int>>(d, "fixed_first");
    for (int i = 0; i < S.nx; ++i)
        solver.newton.riccati().fixed_first[at(i)] = static_cast<char>(fixed[at(i)]);
    for (int i = S.nx; S.carry && i < S.ns(); ++i) solver.newton.riccati().fixed_first[at(i)] = 1;
    solver.lambda.clear(), solver.zl.clear(), solver.zu.clear();
    std::fill(solver.q_zl.begin(), solver.q_zl.end(), 0.0);
    std::fill(solver.q_zu.begin(), solver.q_zu.end(), 0.0);
}

void load_multipliers(InteriorPoint& solver, const Structure& S, const nb::dict& d) {
    fill(solver.lambda, d, "lambda"), fill(solver.zl, d, "zl"), fill(solver.zu, d, "zu");
    solver.q_zl = get<std::vector<double>>(d, "q_zl");
    solver.q_zu = get<std::vector<double>>(d, "q_zu");
    solver.pin_multipliers = get<std::vector<double>>(d, "pin_multipliers");
    const auto y = get<std::vector<Table>>(d, "y");
    for (int c = 0; c <= S.classes(); ++c) {
        GroupState& group = solver.groups[at(c)];
        fill(group.y, y[at(c)]);
        for (int i = 0; i < group.y.rows(); ++i)
            for (int k = 0; k < group.count; ++k) {
                const double value = group.y.row(i)[k];
                group.zl.row(i)[k] = std::isfinite(group.lower.row(i)[k]) ? std::max(-value, 1e-8) : 0;
                group.zu.row(i)[k] = std::isfinite(group.upper.row(i)[k]) ? std::max(value, 1e-8) : 0;
            }
    }
}

namespace {

// One row of gains a segment: nu rows of nx each.
Written gains_of(InteriorPoint& solver, const Structure& S, int segments) {
    const int size = S.nu * S.nx;
    double* to = nullptr;
    Written written = rows_of(segments, size, to);
    for (int k = 0; k < segments; ++k) solver.newton.gains(k, to + k * size);
    return written;
}

// One value for every unknown of the program, in its order: f(row, column) or g(global).
template <class F, class G>
Written in_order(const Bound& self, F f, G g) {
    const std::size_t columns = at(self.structure.N + 1), count = self.places.size();
    double* to = nullptr;
    Written written = rows_of(1, static_cast<int>(count) + self.structure.nq, to);
    for (std::size_t i = 0; i < count; ++i)
        to[i] = f(static_cast<int>(self.places[i] / columns), self.places[i] % columns);
    for (std::size_t i = 0; i < at(self.structure.nq); ++i) to[count + i] = g(i);
    return written;
}

// Multipliers of the defects, unscaled: (N, (s − 1) nx).
Written defect_multipliers(const InteriorPoint& solver, const Structure& S) {
    double* to = nullptr;
    Written written = rows_of(S.N, S.interior(), to);
    for (int i = 0; i < S.interior(); ++i) {
        const double scale = solver.objective_scale * solver.defect_scale[at(i % S.nx)];
        for (int k = 0; k < S.N; ++k) to[k * S.interior() + i] = solver.lambda.row(i)[k] / scale;
    }
    return written;
}

// Unknowns and multipliers as the program has them, unscaled; rows of paths and rates as they are.
nb::dict result_of(const Bound& self, Outcome outcome) {
    InteriorPoint& solver = *self.solver;
    const Structure& S = self.structure;
    const double sigma = solver.objective_scale;
    solver.complete_fixed();
    nb::dict r;
    r["outcome"] = static_cast<int>(outcome);
    r["z"] = in_order(
        self, [&](int row, std::size_t k) { return solver.z.row(row)[k] * solver.scale.row(row)[0]; },
        [&](std::size_t i) { return solver.q[i] * solver.q_scale[i]; });
    r["bounds"] = in_order(
        self,
        [&](int row, std::size_t k) {
            return (solver.zu.row(row)[k] - solver.zl.row(row)[k]) / (sigma * solver.scale.row(row)[0]);
        },
        [&](std::size_t i) { return (solver.q_zu[i] - solver.q_zl[i]) / (sigma * solver.q_scale[i]); });
    r["defects"] = defect_multipliers(solver, S);
    nb::list y;
    for (const GroupState& group : solver.groups) y.append(table(group.y, group.count));
    r["y"] = y;
    r["iterations"] = solver.iterations;
    r["restorations"] = solver.restorations;
    r["barrier"] = solver.barrier;
    r["factorisations"] = solver.newton.factorisations;
    r["solves"] = solver.newton.solves;
    r["value_runs"] = solver.points.value_runs;
    r["full_runs"] = solver.points.full_runs;
    std::vector<std::vector<double>> history;
    for (const Record& h : solver.history)
        history.push_back({h.objective, h.primal, h.dual, h.barrier, h.step, h.regularisation});
    r["history"] = history;
    const bool solved = outcome == Outcome::solved || outcome == Outcome::acceptable;
    r["gains"] = gains_of(solver, S, solved && solver.factor_here() ? S.N : 0);
    return r;
}

nb::dict solve(Bound& self, const nb::dict& data, const nb::dict& options, nb::object callback) {
    InteriorPoint& solver = *self.solver;
    Settings settings;
    settings.tolerance = get<double>(options, "tolerance");
    settings.max_iterations = get<int>(options, "max_iterations");
    settings.max_seconds = get<double>(options, "max_seconds");
    settings.barrier_start = get<double>(options, "barrier_start");
    settings.push = get<double>(options, "push");
    settings.refinements = get<int>(options, "refinements");
    settings.acceptable_factor = get<double>(options, "acceptable_factor");
    settings.warm = get<bool>(options, "warm");
    const bool interruptible = get<bool>(options, "interruptible");
    load(solver, self.structure, data);
    if (settings.warm) load_multipliers(solver, self.structure, data);
    solver.newton.factorisations = solver.newton.solves = 0;
    solver.points.value_runs = solver.points.full_runs = solver.restorations = 0;
    const auto watch = [&](const Record& h) {
        if (callback.is_none() && !interruptible) return false;
        const nb::gil_scoped_acquire held;
        if (PyErr_CheckSignals() != 0) {
            PyErr_Clear();
            return true;
        }
        if (callback.is_none()) return false;
        const nb::object stop = callback(solver.iterations, h.objective, h.primal, h.dual,
                                         h.barrier, h.step, h.regularisation);
        return !stop.is_none() && nb::cast<bool>(stop);
    };
    Outcome outcome;
    {
        const nb::gil_scoped_release released;
        outcome = solver.solve(settings, watch);
    }
    return result_of(self, outcome);
}

}  // namespace

void bind_interior_point(nb::module_& module) {
    nb::class_<Bound>(module, "InteriorPoint", "Interior point on one structure.")
        .def("__init__",
             [](Bound* place, const nb::dict& structure, const Tape& value, const Tape& full,
                const Tape& terminal) {
                 Structure S = structure_of(structure);
                 auto solver = std::make_unique<InteriorPoint>(S, value, full, terminal);
                 const auto places = get<Places>(structure, "places");
                 new (place) Bound{std::move(S),
                                   {places.data(), places.data() + places.shape(0)},
                                   std::move(solver)};
             },
             nb::keep_alive<1, 3>(), nb::keep_alive<1, 4>(), nb::keep_alive<1, 5>())
        .def("elimination_work",
             [](const Bound& self) {
                 const Elimination& e = self.solver->newton.elimination();
                 return std::vector<std::size_t>{e.factor.multiplications(),
                                                 e.reduce.multiplications(),
                                                 e.expand.multiplications(), e.segment_rows,
                                                 e.factor.slots()};
             },
             "Multiply-adds a segment of factor, reduce and expand; rows kept; slots.")
        .def("solve", &solve, nb::arg("data"), nb::arg("options"),
             nb::arg("callback") = nb::none());
}

}  // namespace skyknot::inline SKYKNOT_ISA
