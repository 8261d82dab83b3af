// Cholesky factor of eight columns at a time, in registers.
//
// Legend: the columns hold [C_11; C_21], C_11 eight by eight; they become [L; C_21 L⁻ᵀ], C_11 = L Lᵀ.
#pragma once

#include <limits>

#include "transpose.hpp"
#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// The first 8 R rows of `count` ≤ 8 columns; inverse: 1 / L_pp. False when a pivot is not positive.
//
// C = L̃ D L̃ᵀ first, roots of D at the end. What every pivot waits for is kept short: it comes from
// two numbers, not from the columns, whose update runs beside the next division.
template <int R>
[[gnu::noinline]] bool factor_columns(double* columns, int ld, int count, double* inverse) {
    constexpr Wide lane = {0, 1, 2, 3, 4, 5, 6, 7};
    Wide c[8][R];
#pragma GCC unroll 8
    for (int j = 0; j < 8; ++j)  // missing columns are those of the identity
#pragma GCC unroll 3
        for (int r = 0; r < R; ++r) {
            const double unit = r == 0 ? j : -1;
            c[j][r] = j < count ? load_wide(columns + j * ld + 8 * r)
                                : Wide(lane == unit ? Wide{} + 1.0 : Wide{});
        }
    Wide pivots = {};
    double pivot = c[0][0][0];
#pragma GCC unroll 8
    for (int p = 0; p < 8; ++p) {
        pivots = lane == double(p) ? Wide{} + pivot : pivots;
        const double over = 1.0 / pivot;
        if (p == 7) break;
        const double below = c[p][0][p + 1];
        pivot = c[p + 1][0][p + 1] - below * below * over;
        Wide scaled[R];
#pragma GCC unroll 3
        for (int r = 0; r < R; ++r) scaled[r] = c[p][r] * over;
#pragma GCC unroll 8
        for (int j = p + 1; j < 8; ++j) {
            const double factor = c[p][0][j];
#pragma GCC unroll 3
            for (int r = 0; r < R; ++r) c[j][r] -= scaled[r] * factor;
        }
    }
    const Lanes<8> D = load8(reinterpret_cast<const double*>(&pivots));
    if (any((D > 0.0) & (D <= std::numeric_limits<double>::max()) ^ std::int64_t{-1})) return false;
    double scale[8];
    (1.0 / square_root(D)).store(scale);
#pragma GCC unroll 8
    for (int p = 0; p < 8; ++p) {
        if (p >= count) break;
        inverse[p] = scale[p];
        c[p][0] = lane >= double(p) ? c[p][0] : Wide{};
#pragma GCC unroll 3
        for (int r = 0; r < R; ++r) store_wide(columns + p * ld + 8 * r, c[p][r] * scale[p]);
    }
    return true;
}

// Rows below those: X ← X L⁻ᵀ, eight rows of `count` columns.
inline void solve_rows(const double* L, double* rows, int ld, int count, const double* inverse) {
    for (int p = 0; p < count; ++p) {
        Wide sum = load_wide(rows + p * ld);
        for (int j = 0; j < p; ++j) sum -= load_wide(rows + j * ld) * L[j * ld + p];
        store_wide(rows + p * ld, sum * inverse[p]);
    }
}

// L⁻¹ of eight by eight, row-major, from L's first `count` columns; rows past them are zero.
[[gnu::noinline]] inline void invert_rows(const double* L, int ld, int count, const double* inverse,
                                          double* to) {
    constexpr Wide lane = {0, 1, 2, 3, 4, 5, 6, 7};
    Wide row[8];
#pragma GCC unroll 8
    for (int p = 0; p < 8; ++p) row[p] = lane == double(p) ? Wide{} + 1.0 : Wide{};
#pragma GCC unroll 8
    for (int p = 0; p < 8; ++p) {
        if (p >= count) {
            store_wide(to + 8 * p, Wide{});
            continue;
        }
        row[p] *= inverse[p];
        store_wide(to + 8 * p, row[p]);
#pragma GCC unroll 8
        for (int j = p + 1; j < 8; ++j) row[j] -= row[p] * L[p * ld + j];
    }
}

// `rows` rows, a multiple of eight, of `count` ≤ 8 columns.
inline bool factor_panel(double* columns, int ld, int rows, int count, double* inverse) {
    const bool done = rows >= 24   ? factor_columns<3>(columns, ld, count, inverse)
                      : rows == 16 ? factor_columns<2>(columns, ld, count, inverse)
                                   : factor_columns<1>(columns, ld, count, inverse);
    for (int r = 24; done && r < rows; r += 8)
        solve_rows(columns, columns + r, ld, count, inverse);
    return done;
}

}  // namespace skyknot::inline SKYKNOT_ISA
