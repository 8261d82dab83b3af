// Sparse linear algebra of one segment, written once and run for eight segments at a time.
//
// A Builder records multiply–add instructions over values; structural zeros and ones vanish while
// recording, so that what runs is exactly the arithmetic the sparsity pattern leaves. `finish`
// orders the instructions into runs of one shape, so that the processor predicts every jump, and
// gives every value a slot of eight lanes, reusing slots whose value is no longer needed.
#pragma once

#include <array>
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
using Eight = std::array<Value, 8>;

// Eight values that stand side by side in the workspace.
struct Row8 {
    std::uint32_t number;
};

// Blocks of eight segments, one after the other, that a program writes to segment by segment.
struct Blocks {
    double* at;          // the first segment's block
    std::size_t stride;  // from one segment's block to the next, in doubles
};

// One run of a program.
struct Pass {
    // Row buffers; an instruction adds its own row offset and `first`.
    const double* const* sources;
    double* const* targets = nullptr;
    const double* scalars = nullptr;  // broadcast
    std::ptrdiff_t first = 0;
    // Rows of eight, then placed values, stand at its front; it must be zero before the first run and
    // serve no other program.
    double* workspace;
    const Blocks* blocks = nullptr;
    // How many segments there are from `first`: beyond them, no block is written. With more than
    // eight, sixteen run side by side, which hides how long a sum waits for another; the workspace
    // is two then, the second stored block stands `stored_stride` doubles behind the first, and a
    // program that reads rows which stand eight columns after eight, or writes panels, refuses.
    int filled = lane_count;
    std::size_t stored_stride = 0;
};

class MicroProgram {
public:
    void run(const Pass& pass) const;

    std::size_t slots() const { return slots_; }
    // Where in the workspace lane `lane` of sixteen stands of a value placed at `place`.
    std::size_t entry(std::uint32_t place, int lane) const {
        const auto group = static_cast<std::size_t>(lane / lane_count);
        return group * lane_count * slots_ + place + static_cast<std::size_t>(lane % lane_count);
    }
    std::size_t multiplications() const { return multiplications_; }

private:
    friend class Builder;
    // Half the bytes where sixteen bits are enough: the code streams past the first-level cache.
    std::vector<std::uint16_t> narrow_;
    std::vector<std::uint32_t> wide_;
    std::vector<std::pair<std::uint32_t, double>> constants_;
    std::uint32_t stored_source_ = UINT32_MAX;
    bool alone_ = false;  // eight segments at a time only
    std::size_t slots_ = 0, multiplications_ = 0;
};

class Builder {
public:
    explicit Builder(std::size_t stride) : stride_(stride) {}

    Value constant(double value);
    // Row `row` of source `source`, read at first + shift.
    Value input(std::uint32_t source, std::size_t row, std::ptrdiff_t shift = 0);
    // Row `row` of a block that holds eight segments only, rows one after the other; of one source.
    // Where every term of a dot has such a factor, or a one, it is read where it stands; row 0 of
    // the block must be ones for the latter, and numbers in any case.
    Value stored(std::uint32_t source, std::size_t row) {
        stored_source_ = source;
        return read(load_stored, source, static_cast<std::uint32_t>(row * lane_count));
    }
    // Row `row` of a source whose rows, `rows` of them, stand eight columns after eight; its pointer
    // is to the block of column `first`, less `first`. `next`: one column further.
    Value block_input(std::uint32_t source, std::size_t row, std::size_t rows, bool next);
    Value scalar(std::uint32_t index);
    // A value that the caller writes into the workspace, at its place, before every run.
    Value reserve();

    // start + Σ a b, or start − Σ a b.
    Value dot(const std::vector<Term>& terms, Value start = {}, bool subtract = false);
    Value product(Value a, Value b) { return dot({{a, b}}); }
    Value sum(Value a, Value b) { return dot({{one(), b}}, a); }
    Value reciprocal(Value a);
    // Written at `offset` doubles (+ first) of target `target`.
    void output(std::uint32_t target, std::size_t offset, Value value);
    // Kept in the workspace until the next run: returns where, in doubles; 0, where zeros stand, for
    // a structural zero.
    std::uint32_t place(Value value);
    // Values kept side by side, for `panel`.
    Row8 row8(const Eight& values);
    // Written side by side at `offset` of every segment's block of `target`.
    void block(std::uint32_t target, std::size_t offset, const Eight& values);
    // The same of start + Σ a row: a row of a product of two matrices, without a slot for its sums.
    void panel(std::uint32_t target, std::size_t offset, const Eight& start,
               const std::vector<std::pair<Value, Row8>>& terms);
    // What is recorded from here on runs after all that stands before.
    void next_phase() { ++phase_; }

    Value one() { return constant(1.0); }
    bool is_one(Value v) const { return !v.is_zero() && v.id == one_; }

    MicroProgram finish();

    enum Kind : std::uint32_t {
        dot_add,
        dot_subtract,
        stored_add,
        stored_subtract,
        load,
        load_stored,
        load_further,
        scalar_load,
        invert,
        store,
        block_store,
        panel_store,
        panel_start_store
    };

private:
    struct Step {
        Kind kind;
        std::int32_t result, start;
        std::uint32_t buffer;
        std::uint32_t offset;
        // pairs of factors; of a panel, a factor and the number of a row; of a stored dot, an offset
        // in the block and a factor
        std::vector<std::pair<std::int32_t, std::int32_t>> terms;
        Eight eight{};  // what a block is written from, or a panel starts from
        std::uint32_t further = 0;  // from one block of a source to the next
        std::uint32_t phase = 0;
        bool writes() const { return kind >= store; }
        bool is_panel() const { return kind == panel_store || kind == panel_start_store; }
        bool is_stored() const { return kind == stored_add || kind == stored_subtract; }
    };
    Value record(Step step);
    void write(Step step);
    Value read(Kind kind, std::uint32_t source, std::uint32_t offset, std::uint32_t further = 0);
    template <class Visit>
    void visit_operands(const Step& step, Visit visit) const;
    static std::uint32_t shape(const Step& step);
    void read_stored_in_place();
    template <class SlotOf>
    void write_code(const Step& step, SlotOf of, std::vector<std::uint32_t>& code) const;
    std::vector<std::uint32_t> encode(const std::vector<std::size_t>& order, MicroProgram& program);
    std::vector<std::size_t> scheduled() const;

    std::size_t stride_;
    std::int32_t values_ = 0, one_ = -2;
    std::vector<Step> steps_;
    std::vector<std::pair<std::int32_t, double>> constants_;
    std::map<std::pair<Kind, std::uint64_t>, std::int32_t> inputs_;
    std::map<std::vector<std::int32_t>, std::int32_t> dots_;  // said once, computed once
    std::vector<Eight> rows8_;
    std::vector<std::uint32_t> rows8_places_;
    // Values that keep a slot of their own: those of rows of eight, and placed ones; slot by value.
    std::unordered_map<std::int32_t, std::uint32_t> homes_;
    std::uint32_t next_home_ = 1;  // slot 0 holds zeros
    std::uint32_t phase_ = 0, stored_source_ = UINT32_MAX;
    bool alone_ = false;
};

}  // namespace skyknot::inline SKYKNOT_ISA
