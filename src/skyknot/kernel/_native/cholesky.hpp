// Cholesky factor of eight columns at a time, in registers.
//
// Legend: the columns hold [C_11; C_21], C_11 eight by eight; they become [L; C_21 L⁻ᵀ], C_11 = L Lᵀ.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "transpose.hpp"
#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// The first 8 R rows of `count` ≤ 8 columns; inverse: 1 / L_pp. False when a pivot is not positive.
//
// For vectors of less than eight, which have no registers for all of it: column after column.
template <int R>
bool factor_narrow(double* columns, int ld, int count, double* inverse) {
    for (int p = 0; p < count; ++p) {
        double* const column = columns + p * ld;
        Vector8 sum[R];
        for (int r = 0; r < R; ++r) sum[r] = load8(column + 8 * r);
        for (int l = 0; l < p; ++l) {
            const Vector8 factor = broadcast8(columns[l * ld + p]);
            for (int r = 0; r < R; ++r) sum[r] -= load8(columns + l * ld + 8 * r) * factor;
        }
        store8(column, sum[0]);
        const double pivot = column[p];
        if (!(pivot > 0.0) || !std::isfinite(pivot)) return false;
        inverse[p] = 1.0 / std::sqrt(pivot);
        for (int r = 0; r < R; ++r) store8(column + 8 * r, sum[r] * inverse[p]);
        std::fill_n(column, p, 0.0);
    }
    return true;
}

// The same with all columns in registers.
//
// C = L̃ D L̃ᵀ first, roots of D at the end. What every pivot waits for is kept short: it comes from
// two numbers, not from the columns, whose update runs beside the next division.
template <int R>
[[gnu::noinline]] bool factor_columns(double* columns, int ld, int count, double* inverse) {
    if constexpr (native_width < 8) return factor_narrow<R>(columns, ld, count, inverse);
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
        Vector8 sum = load8(rows + p * ld);
        for (int j = 0; j < p; ++j) sum -= load8(rows + j * ld) * L[j * ld + p];
        store8(rows + p * ld, sum * inverse[p]);
    }
}

// L⁻¹ of eight by eight, row-major, from L's first `count` columns; rows past them are zero.
#if defined(__AVX512F__)
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
#else
inline void invert_rows(const double* L, int ld, int count, const double* inverse, double* to) {
    std::fill_n(to, 64, 0.0);
    for (int p = 0; p < count; ++p) {
        to[8 * p + p] = 1.0;
        Vector8 row = load8(to + 8 * p);
        for (int j = 0; j < p; ++j) row -= L[j * ld + p] * load8(to + 8 * j);
        store8(to + 8 * p, row * inverse[p]);
    }
}
#endif

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
