// Products of small column-major matrices with rows padded to eight, kept in registers.
#pragma once

#include "transpose.hpp"
#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// A library call costs more than these few vectors; `count` is a multiple of eight.
SKYKNOT_INLINE void copy8(const double* from, double* to, int count) {
    for (int i = 0; i < count; i += 8) store8(to + i, load8(from + i));
}

// What a product is added to: nothing, or a matrix, which may be the result itself.
struct Base {
    const double* at = nullptr;
    int stride = 0;
};

// C(:, j) = base(:, j) + sign Σ_l A(:, l) B(l, j) for R vectors of eight rows and J columns.
template <int R, int J>
[[gnu::always_inline]] inline void block(Base base, const double* A, int lda, const double* B,
                                         int b_row, int b_column, double* C, int ldc, int depth,
                                         double sign) {
    Vector8 sum[R][J];
    for (int r = 0; r < R; ++r)
        for (int j = 0; j < J; ++j) sum[r][j] = Vector8{};
    for (int l = 0; l < depth; ++l) {
        Vector8 a[R];
        for (int r = 0; r < R; ++r) a[r] = load8(A + l * lda + 8 * r);
        for (int j = 0; j < J; ++j) {
            const Vector8 b = broadcast8(B[l * b_row + j * b_column]);
            for (int r = 0; r < R; ++r) sum[r][j] += a[r] * b;
        }
    }
    for (int j = 0; j < J; ++j)
        for (int r = 0; r < R; ++r) {
            double* c = C + j * ldc + 8 * r;
            if (base.at) store8(c, load8(base.at + j * base.stride + 8 * r) + sign * sum[r][j]);
            else store8(c, sign * sum[r][j]);
        }
}

template <int R>
inline void columns(Base base, const double* A, int lda, const double* B, int b_row, int b_column,
                    double* C, int ldc, int depth, int count, double sign) {
    constexpr int J = R >= 3 ? 4 : R == 2 ? 6 : 8;  // with all eight at R = 3, GCC spills
    int j = 0;
    const auto from = [&]() { return Base{base.at ? base.at + j * base.stride : nullptr, base.stride}; };
    for (; j + J <= count; j += J)
        block<R, J>(from(), A, lda, B + j * b_column, b_row, b_column, C + j * ldc, ldc, depth, sign);
    for (; j + 2 <= count; j += 2)
        block<R, 2>(from(), A, lda, B + j * b_column, b_row, b_column, C + j * ldc, ldc, depth, sign);
    for (; j < count; ++j)
        block<R, 1>(from(), A, lda, B + j * b_column, b_row, b_column, C + j * ldc, ldc, depth, sign);
}

// C = base + sign A B: A (rows, depth) with leading dimension lda, B read at
// [l b_row + j b_column], C (rows, count). `rows` is a multiple of eight.
inline void multiply(Base base, const double* A, int lda, const double* B, int b_row, int b_column,
                     double* C, int ldc, int rows, int depth, int count, double sign = 1.0) {
    int r = 0;
    const auto from = [&]() { return Base{base.at ? base.at + r : nullptr, base.stride}; };
    for (; rows - r >= 24; r += 24)
        columns<3>(from(), A + r, lda, B, b_row, b_column, C + r, ldc, depth, count, sign);
    if (rows - r == 16)
        columns<2>(from(), A + r, lda, B, b_row, b_column, C + r, ldc, depth, count, sign);
    if (rows - r == 8)
        columns<1>(from(), A + r, lda, B, b_row, b_column, C + r, ldc, depth, count, sign);
}

// C += sign A B.
inline void multiply_add(const double* A, int lda, const double* B, int b_row, int b_column,
                         double* C, int ldc, int rows, int depth, int count, double sign = 1.0) {
    multiply({C, ldc}, A, lda, B, b_row, b_column, C, ldc, rows, depth, count, sign);
}

// out = base + sign A b for R vectors of eight rows; sums of even and odd columns, so that they do not
// wait for each other.
template <int R>
[[gnu::always_inline]] inline void vector_block(const double* base, const double* A, int lda,
                                                const double* b, double* out, int depth,
                                                double sign) {
    Vector8 even[R], odd[R];
    for (int r = 0; r < R; ++r) even[r] = odd[r] = Vector8{};
    int l = 0;
    for (; l + 2 <= depth; l += 2) {
        const Vector8 first = broadcast8(b[l]), second = broadcast8(b[l + 1]);
        for (int r = 0; r < R; ++r) {
            even[r] += load8(A + l * lda + 8 * r) * first;
            odd[r] += load8(A + (l + 1) * lda + 8 * r) * second;
        }
    }
    if (l < depth)
        for (int r = 0; r < R; ++r) even[r] += load8(A + l * lda + 8 * r) * broadcast8(b[l]);
    for (int r = 0; r < R; ++r) store8(out + 8 * r, load8(base + 8 * r) + sign * (even[r] + odd[r]));
}

// out = base + sign A b: A (rows, depth), `rows` a multiple of eight; out may be base.
inline void multiply_vector(const double* base, const double* A, int lda, const double* b, double* out,
                            int rows, int depth, double sign = 1.0) {
    int r = 0;
    for (; rows - r >= 24; r += 24)
        vector_block<3>(base + r, A + r, lda, b, out + r, depth, sign);
    if (rows - r == 16) vector_block<2>(base + r, A + r, lda, b, out + r, depth, sign);
    if (rows - r == 8) vector_block<1>(base + r, A + r, lda, b, out + r, depth, sign);
}

// Entry j: the product of `row(j)` with b, both `length` long, a multiple of eight; zero from
// `count` ≤ 8 on.
template <class Row>
[[gnu::always_inline]] inline Wide row_products(Row row, int count, const double* b, int length) {
    Vector8Block products;
#pragma GCC unroll 8
    for (int j = 0; j < 8; ++j) {
        Wide sum{};
        if (j < count) {
            const double* const a = row(j);
            for (int i = 0; i < length; i += 8) sum += load_wide(a + i) * load_wide(b + i);
        }
        products.rows[j] = sum;
    }
    return products.sums();
}

}  // namespace skyknot::inline SKYKNOT_ISA
