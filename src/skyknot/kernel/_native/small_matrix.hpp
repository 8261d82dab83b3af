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

// A product A B: A (rows, depth) with leading dimension lda, B read at [l b_row + j b_column].
struct Product {
    const double* A = nullptr;
    int lda = 0;
    const double* B = nullptr;
    int b_row = 0, b_column = 0;
    int depth = 0;

    SKYKNOT_INLINE Product from(int row, int column) const {
        return {A + row, lda, B + column * b_column, b_row, b_column, depth};
    }
};

template <int R, int J>
SKYKNOT_INLINE void add_terms(const Product& product, Vector8 (&sum)[R][J], double sign) {
    for (int l = 0; l < product.depth; ++l) {
        Vector8 a[R];
        for (int r = 0; r < R; ++r) a[r] = load8(product.A + l * product.lda + 8 * r);
        for (int j = 0; j < J; ++j) {
            const Vector8 b = broadcast8(product.B[l * product.b_row + j * product.b_column]);
            for (int r = 0; r < R; ++r)
                sum[r][j] = sign > 0.0 ? sum[r][j] + a[r] * b : sum[r][j] - a[r] * b;
        }
    }
}

// C(:, j) = base(:, j) + plus − minus for R vectors of eight rows and J columns.
template <int R, int J>
SKYKNOT_INLINE void block(Base base, const Product& plus, const Product& minus, double* C, int ldc) {
    Vector8 sum[R][J];
    for (int r = 0; r < R; ++r)
        for (int j = 0; j < J; ++j) sum[r][j] = Vector8{};
    add_terms<R, J>(plus, sum, 1.0);
    add_terms<R, J>(minus, sum, -1.0);
    for (int j = 0; j < J; ++j)
        for (int r = 0; r < R; ++r) {
            double* c = C + j * ldc + 8 * r;
            if (base.at) store8(c, load8(base.at + j * base.stride + 8 * r) + sum[r][j]);
            else store8(c, sum[r][j]);
        }
}

template <int R>
inline void columns(Base base, const Product& plus, const Product& minus, double* C, int ldc,
                    int count) {
    // enough sums not to wait for one, and no more than there are registers for
    constexpr int J = native_width == 8 ? (R == 1 ? 8 : 4) : R == 1 ? 4 : R == 2 ? 3 : 2;
    int j = 0;
    const auto from = [&]() { return Base{base.at ? base.at + j * base.stride : nullptr, base.stride}; };
    for (; j + J <= count; j += J)
        block<R, J>(from(), plus.from(0, j), minus.from(0, j), C + j * ldc, ldc);
    for (; j + 2 <= count; j += 2)
        block<R, 2>(from(), plus.from(0, j), minus.from(0, j), C + j * ldc, ldc);
    for (; j < count; ++j)
        block<R, 1>(from(), plus.from(0, j), minus.from(0, j), C + j * ldc, ldc);
}

// C = base + plus − minus: C (rows, count), `rows` a multiple of eight.
inline void multiply(Base base, const Product& plus, const Product& minus, double* C, int ldc,
                     int rows, int count) {
    int r = 0;
    const auto from = [&]() { return Base{base.at ? base.at + r : nullptr, base.stride}; };
    for (; rows - r >= 24; r += 24)
        columns<3>(from(), plus.from(r, 0), minus.from(r, 0), C + r, ldc, count);
    if (rows - r == 16) columns<2>(from(), plus.from(r, 0), minus.from(r, 0), C + r, ldc, count);
    if (rows - r == 8) columns<1>(from(), plus.from(r, 0), minus.from(r, 0), C + r, ldc, count);
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

// out[j] = base[j], or zero without a base, + the product of `row(j)` with b, both `length` long, a
// multiple of eight; there are `count` ≤ 8 rows.
template <class Row>
SKYKNOT_INLINE void row_products(const double* base, Row row, int count, const double* b, int length,
                                 double* out) {
    if constexpr (native_width == 8) {
        Wide products[8];
#pragma GCC unroll 8
        for (int j = 0; j < 8; ++j) {
            Wide sum{};
            if (j < count) {
                const double* const a = row(j);
                for (int i = 0; i < length; i += 8) sum += load_wide(a + i) * load_wide(b + i);
            }
            products[j] = sum;
        }
        const Wide sums = row_sums(products);
        store_wide(out, base ? load_wide(base) + sums : sums);
    } else {
        for (int j = 0; j < 8; ++j) {
            Vector8 sum{};
            for (int i = 0; j < count && i < length; i += 8) sum += load8(row(j) + i) * load8(b + i);
            out[j] = base ? base[j] + sum8(sum) : sum8(sum);
        }
    }
}

}  // namespace skyknot::inline SKYKNOT_ISA
