// Sums, maxima and updates of rows, eight entries at a time.
//
// Each takes a function of a reader: `read(p)` gives eight consecutive entries of row p. The last
// entries of a row that is no multiple of eight are read again rather than beyond its end.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {

struct FullRead {
    int k;
    SKYKNOT_INLINE Vector8 operator()(const double* row) const { return load8(row + k); }
};

struct LastRead {
    int k, count;
    SKYKNOT_INLINE Vector8 operator()(const double* row) const {
        double part[8];
        for (int lane = 0; lane < 8; ++lane) part[lane] = row[std::min(k + lane, count - 1)];
        return load8(part);
    }
};

SKYKNOT_INLINE Vector8 larger(const Vector8& a, const Vector8& b) { return select(a > b, a, b); }
SKYKNOT_INLINE Vector8 smaller(const Vector8& a, const Vector8& b) { return select(a < b, a, b); }

// Largest f over a row, at least `at_least`; what is not a number does not count.
template <class F>
SKYKNOT_INLINE double largest(int count, double at_least, F f) {
    Vector8 most = broadcast8(at_least);
    int k = 0;
    for (; k + 8 <= count; k += 8) most = larger(f(FullRead{k}), most);
    if (k < count) most = larger(f(LastRead{k, count}), most);
    double entries[8];
    most.store(entries);
    return *std::max_element(entries, entries + 8);
}

// Smallest f over a row, at most `at_most`; what is not a number does not count.
template <class F>
SKYKNOT_INLINE double smallest(int count, double at_most, F f) {
    Vector8 least = broadcast8(at_most);
    int k = 0;
    for (; k + 8 <= count; k += 8) least = smaller(f(FullRead{k}), least);
    if (k < count) least = smaller(f(LastRead{k, count}), least);
    double entries[8];
    least.store(entries);
    return *std::min_element(entries, entries + 8);
}

template <class F>
SKYKNOT_INLINE double total(int count, F f) {
    Vector8 sum{};
    int k = 0;
    for (; k + 8 <= count; k += 8) sum += f(FullRead{k});
    double rest = 0.0;
    if (k < count) {
        double entries[8];
        f(LastRead{k, count}).store(entries);
        for (int lane = 0; lane < count - k; ++lane) rest += entries[lane];
    }
    return sum8(sum) + rest;
}

SKYKNOT_INLINE double largest_absolute(const double* row, int count, double at_least = 0.0) {
    return largest(count, at_least, [=](auto read) SKYKNOT_LAMBDA { return absolute(read(row)); });
}

SKYKNOT_INLINE double sum_absolute(const double* row, int count) {
    return total(count, [=](auto read) SKYKNOT_LAMBDA { return absolute(read(row)); });
}

// out = f, eight entries at a time.
template <class F>
SKYKNOT_INLINE void assign(int count, double* out, F f) {
    int k = 0;
    for (; k + 8 <= count; k += 8) store8(out + k, f(FullRead{k}));
    if (k < count) {
        double entries[8];
        f(LastRead{k, count}).store(entries);
        for (int lane = 0; lane < count - k; ++lane) out[k + lane] = entries[lane];
    }
}

// Σ log f over a row for f > 0: mantissas are multiplied, exponents added, one logarithm a row.
template <class F>
SKYKNOT_INLINE double log_product(int count, F f) {
    constexpr std::int64_t mantissa = 0x000fffffffffffff, one = 0x3ff0000000000000, bias = 1023;
    Vector8 product = broadcast8(1.0);
    Bits<8> exponents = Bits<8>::all(0);
    const auto multiply = [&](const Vector8& factor) SKYKNOT_LAMBDA {
        const Bits<8> bits = bits_of(product * factor);
        exponents = exponents + (shift_right<52>(bits) - bias);
        product = from_bits((bits & mantissa) | one);
    };
    int k = 0;
    for (; k + 8 <= count; k += 8) multiply(f(FullRead{k}));
    if (k < count) {
        double entries[8];
        f(LastRead{k, count}).store(entries);
        for (int lane = count - k; lane < 8; ++lane) entries[lane] = 1.0;
        multiply(load8(entries));
    }
    double entries[8];
    std::int64_t powers[8];
    product.store(entries), exponents.store(powers);
    double rest = 1.0;
    std::int64_t power = 0;
    for (int lane = 0; lane < 8; ++lane) rest *= entries[lane], power += powers[lane];
    return std::log(rest) + static_cast<double>(power) * 0.693147180559945309417;
}

}  // namespace skyknot::inline SKYKNOT_ISA
