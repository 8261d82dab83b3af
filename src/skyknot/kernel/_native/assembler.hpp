// From CasADi's instruction list to a short program over slots.
//
// Slots hold one scalar for all lanes: first the inputs, then the constants, then registers. Copies
// vanish (an output names the slot it is found in), dead values go, products join the sum that
// alone uses them, sine and cosine of one angle become one instruction. What is left is ordered in
// runs of one operation: a processor guesses wrongly where an interpreter jumps, so it should jump
// once for many instructions.
#pragma once

#include <cstdint>
#include <vector>

#include "operations.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// As CasADi lists it: result = operation(a, b) over work registers. For `input`, a is the input's
// number; for `output`, result is the output's number.
struct Recorded {
    Operation operation;
    std::uint32_t result, a, b;
    double constant;
};

// Slots. c = third operand, except for sin_cos, whose second result it is.
struct Instruction {
    std::uint32_t result, a, b, c;
};

// So many consecutive instructions of one operation.
struct Run {
    Operation operation;
    std::uint32_t length;
};

struct Program {
    std::uint32_t inputs = 0;
    std::uint32_t slots = 0;
    std::vector<double> constants;            // in slots inputs, inputs + 1, …
    std::vector<std::uint32_t> output_slots;  // where each output is found after a run
    std::vector<Run> runs;
    std::vector<Instruction> instructions;
};

// Throws std::invalid_argument on a list that reads what was never written or leaves a gap.
Program assemble(const std::vector<Recorded>& recorded, std::uint32_t inputs,
                 std::uint32_t outputs);

}  // namespace skyknot::inline SKYKNOT_ISA
