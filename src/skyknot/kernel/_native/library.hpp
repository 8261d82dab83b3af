// Rare operations, one lane after the other, by the C library.
#pragma once

#include <cmath>
#include <limits>

#include "lanes.hpp"
#include "operations.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// The y with erf y = x: closed approximation of S. Winitzki (2008, relative error 2e-3), then
// Halley's iteration on erfc, which does not cancel near |x| = 1.
inline double inverse_error_function(double x) {
    const double size = std::fabs(x);
    if (!(size < 1.0))
        return size == 1.0 ? std::copysign(std::numeric_limits<double>::infinity(), x)
                           : std::numeric_limits<double>::quiet_NaN();
    constexpr double a = 0.147, pi = 3.14159265358979323846;
    const double logarithm = std::log1p(-size * size);
    const double t = 2.0 / (pi * a) + 0.5 * logarithm;
    double y = std::sqrt(std::sqrt(t * t - logarithm / a) - t);
    for (int iteration = 0; iteration < 3; ++iteration) {
        const double excess = size < 0.5 ? std::erf(y) - size : (1.0 - size) - std::erfc(y);
        const double newton = excess / (2.0 / std::sqrt(pi) * std::exp(-y * y));
        y -= newton / (1.0 + y * newton);
    }
    return std::copysign(y, x);
}

inline double library_value(Operation operation, double a, double b) {
    switch (operation) {
        case Operation::pow: return std::pow(a, b);
        case Operation::asin: return std::asin(a);
        case Operation::acos: return std::acos(a);
        case Operation::atan: return std::atan(a);
        case Operation::atan2: return std::atan2(a, b);
        case Operation::sinh: return std::sinh(a);
        case Operation::cosh: return std::cosh(a);
        case Operation::asinh: return std::asinh(a);
        case Operation::acosh: return std::acosh(a);
        case Operation::atanh: return std::atanh(a);
        case Operation::fmod: return std::fmod(a, b);
        case Operation::remainder: return std::remainder(a, b);
        case Operation::hypot: return std::hypot(a, b);
        case Operation::erf: return std::erf(a);
        case Operation::erfinv: return inverse_error_function(a);
        case Operation::log1p: return std::log1p(a);
        case Operation::expm1: return std::expm1(a);
        default: return std::numeric_limits<double>::quiet_NaN();
    }
}

template <int L>
[[gnu::noinline]] void library_lanes(Operation operation, const double* a, const double* b,
                                     double* result) {
    for (int i = 0; i < L; ++i) result[i] = library_value(operation, a[i], b[i]);
}

}  // namespace skyknot::inline SKYKNOT_ISA
