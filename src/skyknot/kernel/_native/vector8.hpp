// Eight doubles side by side, whatever the processor's own width.
#pragma once

#include "lanes.hpp"

namespace skyknot::inline SKYKNOT_ISA {

using Vector8 = Lanes<8>;

SKYKNOT_INLINE Vector8 load8(const double* from) { return Vector8::load(from); }
SKYKNOT_INLINE void store8(double* to, const Vector8& v) { v.store(to); }
SKYKNOT_INLINE Vector8 broadcast8(double x) { return Vector8::all(x); }
SKYKNOT_INLINE Vector8& operator+=(Vector8& a, const Vector8& b) { return a = a + b; }
SKYKNOT_INLINE Vector8& operator-=(Vector8& a, const Vector8& b) { return a = a - b; }

template <int L>
SKYKNOT_INLINE void set_last(Lanes<L>& lanes, double value) {
    if constexpr (Lanes<L>::is_native) lanes.vector[L - 1] = value;
    else set_last(lanes.high, value);
}

SKYKNOT_INLINE double sum8(const Vector8& v) {
    double entries[8];
    v.store(entries);
    return ((entries[0] + entries[4]) + (entries[2] + entries[6])) +
           ((entries[1] + entries[5]) + (entries[3] + entries[7]));
}

constexpr int padded8(int n) { return (n + 7) / 8 * 8; }

}  // namespace skyknot::inline SKYKNOT_ISA
