// Doubles aligned to a cache line.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace skyknot::inline SKYKNOT_ISA {

inline constexpr std::align_val_t cache_line{64};

struct AlignedDelete {
    void operator()(double* memory) const { ::operator delete[](memory, cache_line); }
};
using Workspace = std::unique_ptr<double[], AlignedDelete>;

inline Workspace make_workspace(std::size_t size) {
    return Workspace(new (cache_line) double[size]{});
}

}  // namespace skyknot::inline SKYKNOT_ISA
