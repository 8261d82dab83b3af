// The code of micro programs: what builder and runner agree on.
//
// Code: a run is [operation | terms << 6, length] followed by `length` instructions of that shape, each
// [result, start, pairs of factors …], [slot, buffer, offset low, offset high], or
// [target, offset low, offset high, eight slots (when it has them), pairs of factor and row …].
// Slots are offsets in doubles.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace skyknot::inline SKYKNOT_ISA {

constexpr std::uint32_t none = UINT32_MAX, longest_run = UINT16_MAX;

// Terms of a dot are filled up with zeros to the next of these, so that there are few shapes; dots of
// more terms than the last are of the shape 0.
constexpr std::array<std::uint32_t, 8> sizes = {1, 2, 3, 4, 6, 8, 12, 0};

inline std::uint32_t size_of(std::size_t terms) {
    return static_cast<std::uint32_t>(
        std::find_if(sizes.begin(), sizes.end() - 1, [=](std::uint32_t n) { return terms <= n; }) -
        sizes.begin());
}
inline std::uint32_t filled_up(std::size_t terms) {
    const std::uint32_t size = sizes[size_of(terms)];
    return size > 0 ? size : static_cast<std::uint32_t>(terms);
}

// A run's head: the operation in the low bits, the number of terms above.
constexpr std::uint32_t operation_bits = 6;

}  // namespace skyknot::inline SKYKNOT_ISA
