// One row of quantities between bounds, with the multipliers of its bounds (Wächter & Biegler 2006).
//
// Legend: v value, l and u bounds (±inf where free), z_l, z_u ≥ 0 multipliers, μ barrier.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "reductions.hpp"

namespace skyknot::inline SKYKNOT_ISA {

struct Box {
    double *value, *step;
    double *lower, *upper;
    double *zl, *zu, *dzl, *dzu;
    int count;

    // Moves values inside their bounds, by at least κ₁ max(1, |bound|) or κ₂ of the gap.
    void push_inside(double kappa1, double kappa2) {
        for (int k = 0; k < count; ++k) {
            const double l = lower[k], u = upper[k], gap = u - l;
            if (std::isfinite(l))
                value[k] = std::max(
                    value[k], l + std::min(kappa1 * std::max(1.0, std::abs(l)), kappa2 * gap));
            if (std::isfinite(u))
                value[k] = std::min(
                    value[k], u - std::min(kappa1 * std::max(1.0, std::abs(u)), kappa2 * gap));
        }
    }
    void reset_multipliers(double start) {
        for (int k = 0; k < count; ++k) {
            zl[k] = std::isfinite(lower[k]) ? start : 0.0;
            zu[k] = std::isfinite(upper[k]) ? start : 0.0;
        }
    }
    // On the central path: z = μ / distance.
    void reset_multipliers_to(double mu) {
        for (int k = 0; k < count; ++k) {
            zl[k] = std::min(1e3, mu / (value[k] - lower[k]));
            zu[k] = std::min(1e3, mu / (upper[k] - value[k]));
        }
    }
    // Σ = z_l / (v − l) + z_u / (u − v), added to `weight`.
    void add_sigma(double* weight) const {
        assign(count, weight, [&, this](auto read) SKYKNOT_LAMBDA {
            const Vector8 v = read(value);
            return read(weight) + read(zl) / (v - read(lower)) + read(zu) / (read(upper) - v);
        });
    }
    // Gradient of the barrier term, − μ/(v − l) + μ/(u − v), added to `out`.
    void add_barrier_gradient(double mu, double* out) const {
        assign(count, out, [&, this](auto read) SKYKNOT_LAMBDA {
            const Vector8 v = read(value);
            return read(out) + mu / (read(upper) - v) - mu / (v - read(lower));
        });
    }
    void add_multipliers(double* out) const {
        for (int k = 0; k < count; ++k) out[k] += zu[k] - zl[k];
    }
    void multiplier_steps(double mu) {
        assign(count, dzl, [&, this](auto read) SKYKNOT_LAMBDA {
            return (mu - read(zl) * read(step)) / (read(value) - read(lower)) - read(zl);
        });
        assign(count, dzu, [&, this](auto read) SKYKNOT_LAMBDA {
            return (mu + read(zu) * read(step)) / (read(upper) - read(value)) - read(zu);
        });
    }
    double longest_primal(double tau, double at_most) const {
        return smallest(count, at_most, [&, this](auto read) SKYKNOT_LAMBDA {
            const Vector8 v = read(value), d = read(step);
            const Vector8 room = select(d < 0.0, v - read(lower), read(upper) - v);
            return tau * room / absolute(select(d == 0.0, broadcast8(1e-300), d));
        });
    }
    double longest_dual(double tau, double at_most) const {
        const auto reach = [=](const Vector8& z, const Vector8& d) SKYKNOT_LAMBDA {
            return select(d < 0.0, -tau * z / d, broadcast8(1.0));
        };
        return smallest(count, at_most, [&, this](auto read) SKYKNOT_LAMBDA {
            return smaller(reach(read(zl), read(dzl)), reach(read(zu), read(dzu)));
        });
    }
    // Multipliers move, then stay within κ of the central path's.
    void move_multipliers(double alpha, double mu) {
        constexpr double kappa = 1e10;
        const auto move = [=](const Vector8& z, const Vector8& dz, const Vector8& distance)
                              SKYKNOT_LAMBDA {
            const Vector8 central = mu / distance;
            return smaller(larger(z + alpha * dz, central * (1.0 / kappa)), central * kappa);
        };
        assign(count, zl, [&, this](auto read) SKYKNOT_LAMBDA {
            return move(read(zl), read(dzl), read(value) - read(lower));
        });
        assign(count, zu, [&, this](auto read) SKYKNOT_LAMBDA {
            return move(read(zu), read(dzu), read(upper) - read(value));
        });
    }
    // Σ log of the distances at `at`; −inf outside.
    double log_distances(const double* at) const {
        constexpr double most = std::numeric_limits<double>::max();
        const double least = smallest(count, most, [&, this](auto read) SKYKNOT_LAMBDA {
            const Vector8 v = read(at);
            const Vector8 below = v - read(lower), above = read(upper) - v;
            const Vector8 distance = smaller(below, above);
            return select(distance == distance, distance, broadcast8(-1.0));
        });
        if (!(least > 0.0)) return -std::numeric_limits<double>::infinity();
        const auto finite = [](const Vector8& distance) SKYKNOT_LAMBDA {
            return select(distance <= most, distance, broadcast8(1.0));
        };
        return log_product(count, [&, this](auto read) SKYKNOT_LAMBDA {
                   return finite(read(at) - read(lower));
               }) +
               log_product(count, [&, this](auto read) SKYKNOT_LAMBDA {
                   return finite(read(upper) - read(at));
               });
    }
    // Largest |z (v − bound) − μ|.
    double complementarity(double mu) const {
        const auto off = [=](const Vector8& z, const Vector8& distance) SKYKNOT_LAMBDA {
            return select(distance <= std::numeric_limits<double>::max(),
                          absolute(z * distance - mu), Vector8{});
        };
        return largest(count, 0.0, [&, this](auto read) SKYKNOT_LAMBDA {
            const Vector8 v = read(value);
            return larger(off(read(zl), v - read(lower)), off(read(zu), read(upper) - v));
        });
    }
    double multiplier_sum() const {
        return total(count, [this](auto read) SKYKNOT_LAMBDA { return read(zl) + read(zu); });
    }
    // Σ of a step times the gradient of the barrier term.
    double barrier_slope(double mu) const {
        return total(count, [&, this](auto read) SKYKNOT_LAMBDA {
            const Vector8 v = read(value);
            return read(step) * (mu / (read(upper) - v) - mu / (v - read(lower)));
        });
    }
};

}  // namespace skyknot::inline SKYKNOT_ISA
