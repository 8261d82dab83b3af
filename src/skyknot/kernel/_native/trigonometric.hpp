// Sine, cosine and tangent over lanes, at most 2 units in the last place.
//
// Reduction |x| = n π/2 + r by Cody and Waite with π/2 in four pieces (33 + 33 + 33 + 53 bits), r
// held as a sum of two doubles; kernels on |r| ≤ π/4 are the minimax polynomials of fdlibm
// (k_sin.c, k_cos.c, Sun Microsystems 1993). Arguments from 10⁶ on, infinities and NaN go to the C
// library, lane by lane.
#pragma once

#include <cmath>

#include "lanes.hpp"

namespace skyknot::inline SKYKNOT_ISA {

inline constexpr double largest_reduced_angle = 1e6;

// Calls f, a function of the C library, on the lanes marked; the others keep `otherwise`.
template <int L, class F>
[[gnu::noinline]] Lanes<L> by_library(F f, const Bits<L>& where, const Lanes<L>& x,
                                      const Lanes<L>& otherwise) {
    alignas(64) double argument[L], result[L];
    alignas(64) std::int64_t marked[L];
    x.store(argument);
    otherwise.store(result);
    where.store(marked);
    for (int i = 0; i < L; ++i)
        if (marked[i]) result[i] = f(argument[i]);
    return Lanes<L>::load(result);
}

// |x| = n π/2 + head + tail; `quadrant` holds n in its low bits.
template <int L>
struct ReducedAngle {
    Lanes<L> head, tail;
    Bits<L> quadrant;
};

template <int L>
SKYKNOT_INLINE ReducedAngle<L> reduce_angle(const Lanes<L>& magnitude) {
    constexpr double two_over_pi = 6.36619772367581382433e-01;
    constexpr double first = 1.57079632673412561417e+00;   // 33 bits of π/2
    constexpr double second = 6.07710050630396597660e-11;  // the next 33
    constexpr double third = 2.02226624871116645580e-21;   // the next 33
    constexpr double rest = 8.47842766036889956997e-32;
    constexpr double to_integer = 0x1.8p52;  // adding it rounds to an integer, kept in the low bits

    const Lanes<L> shifted = magnitude * two_over_pi + to_integer;
    const Lanes<L> n = shifted - to_integer;
    const Lanes<L> a = magnitude - n * first;  // exact, as are the three products with n < 2²⁰
    const Lanes<L> b = n * second, c = n * third;
    // Two exact differences (Knuth's two-sum): a − b = d + d_error, d − c = e + e_error.
    const Lanes<L> d = a - b, d_part = d - a;
    const Lanes<L> d_error = (a - (d - d_part)) - (b + d_part);
    const Lanes<L> e = d - c, e_part = e - d;
    const Lanes<L> e_error = (d - (e - e_part)) - (c + e_part);
    const Lanes<L> small = (d_error + e_error) - n * rest;
    const Lanes<L> head = e + small;
    return {head, (e - head) + small, bits_of(shifted)};
}

template <int L>
SKYKNOT_INLINE Lanes<L> sine_kernel(const Lanes<L>& x, const Lanes<L>& tail) {
    using V = Lanes<L>;
    const V z = x * x, v = z * x;
    V r = fused(z, V::all(1.58969099521155010221e-10), V::all(-2.50507602534068634195e-08));
    r = fused(z, r, V::all(2.75573137070700676789e-06));
    r = fused(z, r, V::all(-1.98412698298579493134e-04));
    r = fused(z, r, V::all(8.33333333332248946124e-03));
    return x - ((z * (0.5 * tail - v * r) - tail) - v * -1.66666666666666324348e-01);
}

template <int L>
SKYKNOT_INLINE Lanes<L> cosine_kernel(const Lanes<L>& x, const Lanes<L>& tail) {
    using V = Lanes<L>;
    const V z = x * x, half = 0.5 * z, w = 1.0 - half;
    V r = fused(z, V::all(-1.13596475577881948265e-11), V::all(2.08757232129817482790e-09));
    r = fused(z, r, V::all(-2.75573143513906633035e-07));
    r = fused(z, r, V::all(2.48015872894767294178e-05));
    r = fused(z, r, V::all(-1.38888888888741095749e-03));
    r = fused(z, r, V::all(4.16666666666666019037e-02));
    return w + (((1.0 - w) - half) + (z * (z * r) - x * tail));
}

template <int L>
struct SineCosine {
    Lanes<L> sine, cosine;
};

// Sine and cosine of lanes below largest_reduced_angle.
template <int L>
SKYKNOT_INLINE SineCosine<L> reduced_sine_cosine(const Lanes<L>& x) {
    const ReducedAngle<L> angle = reduce_angle(absolute(x));
    const Lanes<L> s = sine_kernel(angle.head, angle.tail);
    const Lanes<L> c = cosine_kernel(angle.head, angle.tail);
    const Bits<L> odd = -(angle.quadrant & std::int64_t{1});
    const Bits<L> sine_sign = shift_left<62>(angle.quadrant & std::int64_t{2}) ^ bits_of(x);
    const Bits<L> cosine_sign = shift_left<62>((angle.quadrant + std::int64_t{1}));
    return {from_bits(bits_of(select(odd, c, s)) ^ (sine_sign & sign_bit)),
            from_bits(bits_of(select(odd, s, c)) ^ (cosine_sign & sign_bit))};
}

// Lanes the reduction cannot serve; written so that NaN is among them.
template <int L>
SKYKNOT_INLINE Bits<L> beyond_reduction(const Lanes<L>& x) {
    return ~std::int64_t{0} ^ (absolute(x) < largest_reduced_angle);
}

template <int L>
SKYKNOT_INLINE SineCosine<L> sine_cosine(const Lanes<L>& x) {
    SineCosine<L> result = reduced_sine_cosine(x);
    const Bits<L> beyond = beyond_reduction(x);
    if (any(beyond)) [[unlikely]] {
        result.sine = by_library([](double v) { return std::sin(v); }, beyond, x, result.sine);
        result.cosine = by_library([](double v) { return std::cos(v); }, beyond, x, result.cosine);
    }
    return result;
}

template <int L>
SKYKNOT_INLINE Lanes<L> sine(const Lanes<L>& x) {
    return sine_cosine(x).sine;
}

template <int L>
SKYKNOT_INLINE Lanes<L> cosine(const Lanes<L>& x) {
    return sine_cosine(x).cosine;
}

template <int L>
SKYKNOT_INLINE Lanes<L> tangent(const Lanes<L>& x) {
    const SineCosine<L> pair = reduced_sine_cosine(x);
    const Lanes<L> result = pair.sine / pair.cosine;
    const Bits<L> beyond = beyond_reduction(x);
    if (!any(beyond)) [[likely]]
        return result;
    return by_library([](double v) { return std::tan(v); }, beyond, x, result);
}

}  // namespace skyknot::inline SKYKNOT_ISA
