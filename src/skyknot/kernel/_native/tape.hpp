// A function of one point, evaluated for L points at once.
//
// Every instruction works on L lanes, so the cost of interpretation is shared by L points. Memory
// is a structure of arrays: scalar k of lane l stands at [k L + l]. Nothing is allocated by
// `prepare`, `run` and `evaluate`; a Tape may be shared by threads, a workspace may not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "assembler.hpp"
#include "lanes.hpp"

namespace skyknot::inline SKYKNOT_ISA {

class Tape {
public:
    Tape(const std::vector<Recorded>& recorded, std::uint32_t inputs, std::uint32_t outputs)
        : program_(assemble(recorded, inputs, outputs)) {}

    std::size_t inputs() const { return program_.inputs; }
    std::size_t outputs() const { return program_.output_slots.size(); }
    std::size_t slots() const { return program_.slots; }
    const Program& program() const { return program_; }

    // Doubles in a workspace of L lanes; align it to 64 bytes.
    std::size_t workspace_size(int L) const { return slots() * static_cast<std::size_t>(L); }

    // The hot road: prepare a workspace once, write the inputs to [k L + lane] at its beginning,
    // run, and read output o at [output_slot(o) L + lane]. Inputs stay, so that a run may follow
    // with only some of them changed.
    template <int L>
    void prepare(double* workspace) const;
    template <int L>
    void run(double* workspace) const;
    std::uint32_t output_slot(std::size_t o) const { return program_.output_slots[o]; }

    // The same with inputs[k L + lane] and outputs[o L + lane] copied in and out of a prepared
    // workspace.
    template <int L>
    void evaluate(const double* inputs, double* outputs, double* workspace) const;

private:
    Program program_;
};

extern template void Tape::prepare<8>(double*) const;
extern template void Tape::prepare<16>(double*) const;
extern template void Tape::run<8>(double*) const;
extern template void Tape::run<16>(double*) const;
extern template void Tape::evaluate<8>(const double*, double*, double*) const;
extern template void Tape::evaluate<16>(const double*, double*, double*) const;

}  // namespace skyknot::inline SKYKNOT_ISA
