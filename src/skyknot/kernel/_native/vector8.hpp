// Eight doubles side by side, whatever the processor's own width: the compiler splits them.
#pragma once

#include <cstring>

namespace skyknot::inline SKYKNOT_ISA {

using Vector8 [[gnu::vector_size(64)]] = double;

[[gnu::always_inline]] inline Vector8 load8(const double* from) {
    Vector8 v;
    std::memcpy(&v, from, sizeof(v));
    return v;
}
[[gnu::always_inline]] inline void store8(double* to, Vector8 v) {
    std::memcpy(to, &v, sizeof(v));
}
[[gnu::always_inline]] inline Vector8 broadcast8(double x) {
    return Vector8{x, x, x, x, x, x, x, x};
}

constexpr int padded8(int n) { return (n + 7) / 8 * 8; }

}  // namespace skyknot::inline SKYKNOT_ISA
