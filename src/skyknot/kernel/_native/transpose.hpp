// An eight by eight block of doubles, turned over in registers.
#pragma once

#include <cstring>

#include "lanes.hpp"

namespace skyknot::inline SKYKNOT_ISA {

using Wide [[gnu::vector_size(64)]] = double;

inline Wide load_wide(const double* from) {
    Wide v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
inline void store_wide(double* to, const Wide& v) { std::memcpy(to, &v, sizeof v); }

// Rows of a square as wide as a native vector become columns.
SKYKNOT_INLINE void turn_square(NativeVector (&rows)[native_width]) {
#if defined(__AVX512F__)
    // Neighbours change places singly, in pairs and in fours.
    Wide single[8], pair[8];
    for (int i = 0; i < 8; i += 2) {
        const Wide a = rows[i], b = rows[i + 1];
        single[i] = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
        single[i + 1] = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int i : {0, 1, 4, 5}) {
        const Wide a = single[i], b = single[i + 2];
        pair[i] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
        pair[i + 2] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    }
    for (int i = 0; i < 4; ++i) {
        const Wide a = pair[i], b = pair[i + 4];
        rows[i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
        rows[i + 4] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
    }
#elif defined(__AVX__)
    const NativeVector a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6),
                       b = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7),
                       c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6),
                       d = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
    rows[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    rows[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    rows[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    rows[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
#else
    const NativeVector a = rows[0], b = rows[1];
    rows[0] = NativeVector{a[0], b[0]};
    rows[1] = NativeVector{a[1], b[1]};
#endif
}

// Eight by eight, a square at a time: column i of the rows from(0) … from(7) goes to to(i), where that
// is not null.
template <class From, class To>
SKYKNOT_INLINE void turn_block(From from, To to) {
    constexpr int w = native_width;
    for (int i = 0; i < 8; i += w)
        for (int j = 0; j < 8; j += w) {
            NativeVector square[w];
            for (int k = 0; k < w; ++k) square[k] = Lanes<w>::load(from(j + k) + i).vector;
            turn_square(square);
            for (int k = 0; k < w; ++k)
                if (double* const out = to(i + k)) Lanes<w>{square[k]}.store(out + j);
        }
}

// Entry i: the sum of row i.
[[gnu::always_inline]] inline Wide row_sums(const Wide (&rows)[8]) {
    Wide single[4], pair[2];
    for (int i = 0; i < 4; ++i) {
        const Wide a = rows[2 * i], b = rows[2 * i + 1];
        single[i] = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14) +
                    __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int i = 0; i < 2; ++i) {
        const Wide a = single[2 * i], b = single[2 * i + 1];
        pair[i] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13) +
                  __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    }
    return __builtin_shufflevector(pair[0], pair[1], 0, 1, 2, 3, 8, 9, 10, 11) +
           __builtin_shufflevector(pair[0], pair[1], 4, 5, 6, 7, 12, 13, 14, 15);
}

}  // namespace skyknot::inline SKYKNOT_ISA
