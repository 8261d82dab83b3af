// Rows of quantities, one column a segment or node, with room before and after for neighbours.
#pragma once

#include <algorithm>
#include <cstddef>

#include "structure.hpp"
#include "workspace.hpp"

namespace skyknot::inline SKYKNOT_ISA {

class RowBuffer {
public:
    RowBuffer() = default;
    RowBuffer(const Structure& structure, int rows)
        : rows_(rows),
          stride_(structure.stride()),
          memory_(make_workspace(static_cast<std::size_t>(rows * structure.stride()) +
                                 2 * Structure::front)) {}

    int rows() const { return rows_; }
    std::ptrdiff_t stride() const { return stride_; }
    // Row 0, segment 0: what a micro program takes as source or target.
    double* origin() { return memory_.get() + Structure::front; }
    const double* origin() const { return memory_.get() + Structure::front; }
    double* row(int i) { return origin() + i * stride_; }
    const double* row(int i) const { return origin() + i * stride_; }

    void clear() { std::fill_n(memory_.get(), size(), 0.0); }
    void copy(const RowBuffer& other) { std::copy_n(other.memory_.get(), size(), memory_.get()); }
    void add(const RowBuffer& other) {
        for (std::size_t i = 0; i < size(); ++i) memory_[i] += other.memory_[i];
    }
    std::size_t size() const {
        return static_cast<std::size_t>(rows_ * stride_) + 2 * Structure::front;
    }

private:
    int rows_ = 0;
    std::ptrdiff_t stride_ = 0;
    Workspace memory_;
};

}  // namespace skyknot::inline SKYKNOT_ISA
