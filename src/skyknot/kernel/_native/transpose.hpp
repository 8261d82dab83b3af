// An eight by eight block of doubles, turned over in registers.
#pragma once

#include <cstring>

namespace skyknot::inline SKYKNOT_ISA {

using Wide [[gnu::vector_size(64)]] = double;

inline Wide load_wide(const double* from) {
    Wide v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
inline void store_wide(double* to, const Wide& v) { std::memcpy(to, &v, sizeof v); }

struct Vector8Block {
    Wide rows[8];

    // Neighbours change places singly, in pairs and in fours.
    [[gnu::always_inline]] void transpose() {
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
    }

    // Entry i: the sum of row i.
    [[gnu::always_inline]] Wide sums() const {
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
};

}  // namespace skyknot::inline SKYKNOT_ISA
