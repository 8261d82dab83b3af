// Rows of quantities, eight columns after eight: what eight points share stands side by side.
//
// A pass over many rows then reads memory in order, and touches few pages, however many columns
// there are.
#pragma once

#include <algorithm>
#include <cstddef>

#include "structure.hpp"
#include "transpose.hpp"
#include "vector8.hpp"
#include "workspace.hpp"

namespace skyknot::inline SKYKNOT_ISA {

class BlockRows {
public:
    BlockRows() = default;
    BlockRows(const Structure& structure, int rows)
        : rows_(rows),
          blocks_(static_cast<std::size_t>(structure.stride() - 2 * Structure::front) / 8),
          memory_(make_workspace(size())) {}

    // From one block to the next, in doubles.
    std::size_t stride() const { return 8 * static_cast<std::size_t>(rows_); }
    // Row 0 of the eight columns that begin with column `first`, a multiple of eight.
    double* block(int first) { return memory_.get() + offset(first); }
    const double* block(int first) const { return memory_.get() + offset(first); }
    double operator()(int row, int column) const {
        return block(column / 8 * 8)[8 * row + column % 8];
    }

    void copy_row(int row, int count, double* to) const {
        for (int first = 0; first < count; first += 8)
            std::copy_n(block(first) + 8 * row, std::min(8, count - first), to + first);
    }
    // Zeros in `count` rows from `row`.
    void clear(int row, int count) {
        for (std::size_t b = 0; b < blocks_; ++b)
            std::fill_n(memory_.get() + b * stride() + 8 * row, 8 * count, 0.0);
    }
    void copy(const BlockRows& other) { std::copy_n(other.memory_.get(), size(), memory_.get()); }

private:
    // One block more than there are columns for, so that the last has a neighbour.
    std::size_t size() const { return (blocks_ + 1) * stride(); }
    std::size_t offset(int first) const { return static_cast<std::size_t>(first) * stride() / 8; }

    int rows_ = 0;
    std::size_t blocks_ = 0;
    Workspace memory_;
};

// Eight entries one column further than `from`: the last stands in the next block.
SKYKNOT_INLINE Vector8 load_next(const double* from, std::size_t stride) {
#if defined(__AVX512F__)
    const Wide here = load_wide(from), next = load_wide(from + stride);
    return {NativeVector(__builtin_shufflevector(here, next, 1, 2, 3, 4, 5, 6, 7, 8))};
#else
    Vector8 eight = load8(from + 1);
    set_last(eight, from[stride]);
    return eight;
#endif
}

}  // namespace skyknot::inline SKYKNOT_ISA
