// Exponential, logarithm and hyperbolic tangent over lanes, at most 2 units in the last place.
//
// exp and log follow fdlibm (e_exp.c, e_log.c, Sun Microsystems 1993); the hyperbolic tangent is
// the rational approximation of Cephes (tanh.c, S. L. Moshier 1984) below 0.625, and
// 1 − 2/(exp 2x + 1) above.
#pragma once

#include <limits>

#include "lanes.hpp"

namespace skyknot::inline SKYKNOT_ISA {

inline constexpr double ln2_high = 6.93147180369123816490e-01;  // 32 bits of ln 2
inline constexpr double ln2_low = 1.90821492927058770002e-10;

// 2ⁿ for an integer n in [−1022, 1023].
template <int L>
SKYKNOT_INLINE Lanes<L> power_of_two(const Lanes<L>& n) {
    return from_bits(shift_left<52>(bits_of(n + (0x1.8p52 + 1023.0))));
}

template <int L>
SKYKNOT_INLINE Lanes<L> exponential(const Lanes<L>& x) {
    using V = Lanes<L>;
    // Beyond these the result is 0 or infinity anyway; NaN passes both comparisons unharmed.
    const V below = select(x > 710.0, V::all(710.0), x);
    const V within = select(below < -746.0, V::all(-746.0), below);
    const V n = (within * 1.44269504088896338700e+00 + 0x1.8p52) - 0x1.8p52;
    const V high = within - n * ln2_high, low = n * ln2_low;
    const V r = high - low, z = r * r;
    V p = fused(z, V::all(4.13813679705723846039e-08), V::all(-1.65339022054652515390e-06));
    p = fused(z, p, V::all(6.61375632143793436117e-05));
    p = fused(z, p, V::all(-2.77777777770155933842e-03));
    p = fused(z, p, V::all(1.66666666666666019037e-01));
    const V c = r - z * p;
    const V y = 1.0 - ((low - (r * c) / (2.0 - c)) - high);
    // In two steps, so that results below the normal range are reached with one rounding.
    const V n1 = (0.5 * n + 0x1.8p52) - 0x1.8p52;
    return y * power_of_two(n1) * power_of_two(n - n1);
}

template <int L>
SKYKNOT_INLINE Lanes<L> logarithm(const Lanes<L>& x) {
    using V = Lanes<L>;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    constexpr double least_normal = std::numeric_limits<double>::min();
    constexpr std::int64_t one = 0x3ff0000000000000, root_half = 0x3fe6a09e00000000;

    // x = 2ᵏ m with m in [√½, √2).
    const Bits<L> tiny = x < least_normal;
    const Bits<L> shifted = bits_of(select(tiny, x * 0x1p54, x)) + (one - root_half);
    const V biased = from_bits(shift_right<52>(shifted) | bits_of(V::all(0x1p52))) - 0x1p52;
    const V k = biased - select(tiny, V::all(1077.0), V::all(1023.0));
    const V f = from_bits((shifted & 0x000fffffffffffff) + root_half) - 1.0;

    const V s = f / (2.0 + f), z = s * s;
    V r = fused(z, V::all(1.479819860511658591e-01), V::all(1.531383769920937332e-01));
    r = fused(z, r, V::all(1.818357216161805012e-01));
    r = fused(z, r, V::all(2.222219843214978396e-01));
    r = fused(z, r, V::all(2.857142874366239149e-01));
    r = fused(z, r, V::all(3.999999999940941908e-01));
    r = z * fused(z, r, V::all(6.666666666666735130e-01));
    const V half_square = 0.5 * f * f;
    const V ordinary = s * (half_square + r) + k * ln2_low - half_square + f + k * ln2_high;

    const V at_zero = select(x == 0.0, V::all(-infinity),
                             V::all(std::numeric_limits<double>::quiet_NaN()));
    const V beyond = select(x == infinity, x, at_zero);
    return select((x > 0.0) & (x < infinity), ordinary, beyond);
}

template <int L>
SKYKNOT_INLINE Lanes<L> hyperbolic_tangent(const Lanes<L>& x) {
    using V = Lanes<L>;
    const V magnitude = absolute(x), z = x * x;
    V p = fused(z, V::all(-9.64399179425052238628e-01), V::all(-9.92877231001918586564e+01));
    p = fused(z, p, V::all(-1.61468768441708447952e+03));
    V q = fused(z, V::all(1.0), V::all(1.12811678491632931402e+02));
    q = fused(z, q, V::all(2.23548839060100448583e+03));
    q = fused(z, q, V::all(4.84406305325125486048e+03));
    const V near = magnitude + magnitude * (z * (p / q));
    const V far = 1.0 - 2.0 / (exponential(2.0 * magnitude) + 1.0);
    return copy_sign(select(magnitude < 0.625, near, far), x);
}

}  // namespace skyknot::inline SKYKNOT_ISA
