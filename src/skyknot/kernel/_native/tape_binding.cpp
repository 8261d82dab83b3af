#include "tape_binding.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "tape.hpp"
#include "workspace.hpp"

namespace nb = nanobind;

namespace skyknot::inline SKYKNOT_ISA {
namespace {

template <class T, int dimensions>
using Array = nb::ndarray<T, nb::ndim<dimensions>, nb::c_contig, nb::device::cpu>;
using Codes = Array<const std::uint32_t, 1>;

std::vector<Recorded> zip(Codes operations, Codes results, Codes a, Codes b,
                          Array<const double, 1> constants) {
    const std::size_t count = operations.size();
    if (std::min({results.size(), a.size(), b.size(), constants.size()}) < count)
        throw std::invalid_argument("the instruction arrays differ in length");
    std::vector<Recorded> recorded(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (operations(i) >= operation_count) throw std::invalid_argument("unknown operation");
        recorded[i] = {Operation{operations(i)}, results(i), a(i), b(i), constants(i)};
    }
    return recorded;
}

void construct(Tape* place, Codes operations, Codes results, Codes a, Codes b,
               Array<const double, 1> constants, std::uint32_t inputs, std::uint32_t outputs) {
    new (place) Tape(zip(operations, results, a, b, constants), inputs, outputs);
}

// Points stand one after the other; a short last block repeats its last point.
template <int L>
void evaluate_points(const Tape& tape, const double* inputs, double* outputs, std::size_t points) {
    const std::size_t n = tape.inputs(), m = tape.outputs();
    const Workspace workspace = make_workspace(tape.workspace_size(L));
    double* w = workspace.get();
    tape.prepare<L>(w);
    for (std::size_t first = 0; first < points; first += L) {
        const std::size_t filled = std::min<std::size_t>(L, points - first);
        for (std::size_t k = 0; k < n; ++k)
            for (std::size_t lane = 0; lane < L; ++lane)
                w[k * L + lane] = inputs[(first + std::min(lane, filled - 1)) * n + k];
        tape.run<L>(w);
        for (std::size_t o = 0; o < m; ++o)
            for (std::size_t lane = 0; lane < filled; ++lane)
                outputs[(first + lane) * m + o] = w[tape.output_slot(o) * L + lane];
    }
}

template <int L>
void evaluate_blocks(const Tape& tape, const double* inputs, double* outputs, std::size_t blocks) {
    const Workspace workspace = make_workspace(tape.workspace_size(L));
    tape.prepare<L>(workspace.get());
    for (std::size_t block = 0; block < blocks; ++block)
        tape.evaluate<L>(inputs + block * tape.inputs() * L, outputs + block * tape.outputs() * L,
                         workspace.get());
}

void check(bool fits) {
    if (!fits) throw std::invalid_argument("array shapes do not fit the tape");
}

void points_binding(const Tape& tape, Array<const double, 2> inputs, Array<double, 2> outputs) {
    check(inputs.shape(1) == tape.inputs() && outputs.shape(1) == tape.outputs() &&
          inputs.shape(0) == outputs.shape(0));
    const nb::gil_scoped_release released;
    evaluate_points<16>(tape, inputs.data(), outputs.data(), inputs.shape(0));
}

void blocks_binding(const Tape& tape, Array<const double, 3> inputs, Array<double, 3> outputs) {
    const std::size_t lanes = inputs.shape(2), blocks = inputs.shape(0);
    check(inputs.shape(1) == tape.inputs() && outputs.shape(1) == tape.outputs() &&
          blocks == outputs.shape(0) && lanes == outputs.shape(2) && (lanes == 8 || lanes == 16));
    const nb::gil_scoped_release released;
    const auto evaluate = lanes == 8 ? &evaluate_blocks<8> : &evaluate_blocks<16>;
    evaluate(tape, inputs.data(), outputs.data(), blocks);
}

nb::dict operation_codes() {
    nb::dict codes;
    for (std::uint32_t code = 0; code < operation_count; ++code)
        codes[nb::cast(operation_facts[code].name)] = code;
    return codes;
}

std::vector<std::string> instruction_names(const Tape& tape) {
    std::vector<std::string> names;
    for (const Run& run : tape.program().runs)
        names.insert(names.end(), run.length,
                     std::string(operation_facts[static_cast<std::uint32_t>(run.operation)].name));
    return names;
}

}  // namespace

void bind_tape(nb::module_& module) {
    module.def("operation_codes", &operation_codes, "Return the code of every operation, by name.");
    nb::class_<Tape>(module, "Tape", "A recorded function of one point, run over lanes.")
        .def("__init__", &construct, nb::arg("operations"), nb::arg("results"), nb::arg("a"),
             nb::arg("b"), nb::arg("constants"), nb::arg("inputs"), nb::arg("outputs"))
        .def_prop_ro("inputs", &Tape::inputs)
        .def_prop_ro("outputs", &Tape::outputs)
        .def_prop_ro("slots", &Tape::slots)
        .def_prop_ro("runs", [](const Tape& tape) { return tape.program().runs.size(); })
        .def("instruction_names", &instruction_names,
             "Return the operation of every instruction left after assembly.")
        .def("evaluate_points", &points_binding, nb::arg("inputs"), nb::arg("outputs"),
             "Evaluate (P, n) point-major inputs into (P, m) outputs, without the GIL.")
        .def("evaluate_blocks", &blocks_binding, nb::arg("inputs"), nb::arg("outputs"),
             "Evaluate (B, n, L) lane-major inputs into (B, m, L) outputs, L = 8 or 16.");
}

}  // namespace skyknot::inline SKYKNOT_ISA
