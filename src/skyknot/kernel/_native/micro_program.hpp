// Sparse linear algebra of one segment, written once and run for eight segments at a time.
//
// A Builder records multiply–add instructions over values; structural zeros and ones vanish while
// recording, so that what runs is exactly the arithmetic the sparsity pattern leaves. `finish`
// orders the instructions into runs of one shape, so that the processor predicts every jump, and
// gives every value a slot of eight lanes, reusing slots whose value is no longer needed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

namespace skyknot::inline SKYKNOT_ISA {

inline constexpr int lane_count = 8;

// A value while recording: a structural zero, or the number of a recorded value.
struct Value {
    std::int32_t id = -1;
    bool is_zero() const { return id < 0; }
    bool operator==(const Value&) const = default;
};

using Term = std::pair<Value, Value>;

class MicroProgram {
public:
    // Runs the instructions for segments first … first + 7. `sources[i]` and `targets[i]` are row
    // buffers; an instruction adds its own row offset and `first`. `scalars` are broadcast. Placed
    // values stand at the front of the workspace, eight lanes each; its first eight are zeros and
    // must be so before the first run.
    void run(const double* const* sources, double* const* targets, const double* scalars,
             std::ptrdiff_t first, double* workspace) const;

    std::size_t slots() const { return slots_; }
    std::size_t multiplications() const { return multiplications_; }

private:
    friend class Builder;
    template <class Code>
    void run(const Code* at, const Code* end, const double* const* sources, double* const* targets,
             const double* scalars, std::ptrdiff_t first, double* workspace) const;
    // Half the bytes where sixteen bits are enough: the code streams past the first-level cache.
    std::vector<std::uint16_t> narrow_;
    std::vector<std::uint32_t> wide_;
    std::vector<std::pair<std::uint32_t, double>> constants_;
    std::size_t slots_ = 0, multiplications_ = 0;
};

class Builder {
public:
    explicit Builder(std::size_t stride) : stride_(stride) {}

    Value zero() const { return {}; }
    Value constant(double value);
    // Row `row` of source `source`, read at first + shift.
    Value input(std::uint32_t source, std::size_t row, std::ptrdiff_t shift = 0);
    // Row `row` of a block that holds eight segments only, rows one after the other.
    Value stored(std::uint32_t source, std::size_t row) {
        return read(source, static_cast<std::uint32_t>(row * lane_count));
    }
    Value scalar(std::uint32_t index);

    // start + Σ a b, or start − Σ a b.
    Value dot(const std::vector<Term>& terms, Value start = {}, bool subtract = false);
    Value product(Value a, Value b) { return dot({{a, b}}); }
    Value sum(Value a, Value b) { return dot({{one(), b}}, a); }
    Value reciprocal(Value a);
    // Written at `offset` doubles (+ first) of target `target`.
    void output(std::uint32_t target, std::size_t offset, Value value);
    // Kept at the front of the workspace until the next run: returns its place there, in groups of
    // eight lanes; 0, where zeros stand, for a structural zero.
    std::uint32_t place(Value value);

    Value one() { return constant(1.0); }
    bool is_one(Value v) const { return !v.is_zero() && v.id == one_; }

    MicroProgram finish();

    enum Kind : std::uint32_t {
        load,
        scalar_load,
        dot_add,
        dot_add_start,
        dot_subtract,
        dot_subtract_start,
        invert,
        store
    };

private:
    struct Step {
        Kind kind;
        std::int32_t result, start;
        std::uint32_t buffer;
        std::uint32_t offset;
        std::vector<std::pair<std::int32_t, std::int32_t>> terms;
    };
    Value record(Step step);
    Value read(std::uint32_t source, std::uint32_t offset);
    std::vector<std::uint32_t> encode(const std::vector<std::size_t>& order, MicroProgram& program);
    std::vector<std::size_t> scheduled() const;

    std::size_t stride_;
    std::int32_t values_ = 0, one_ = -2;
    std::vector<Step> steps_;
    std::vector<std::pair<std::int32_t, double>> constants_;
    std::unordered_map<std::uint64_t, std::int32_t> inputs_;
    std::map<std::vector<std::int32_t>, std::int32_t> dots_;  // said once, computed once
    std::vector<std::int32_t> placed_;                        // values, from place 1 on
    std::unordered_map<std::int32_t, std::uint32_t> places_;
};

}  // namespace skyknot::inline SKYKNOT_ISA
