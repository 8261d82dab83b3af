// One row of quantities between bounds, with the multipliers of its bounds (Wächter & Biegler 2006).
//
// Legend: v value, l and u bounds (±inf where free), z_l, z_u ≥ 0 multipliers, μ barrier.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

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
        for (int k = 0; k < count; ++k)
            weight[k] += zl[k] / (value[k] - lower[k]) + zu[k] / (upper[k] - value[k]);
    }
    // Gradient of the barrier term, − μ/(v − l) + μ/(u − v), added to `out`.
    void add_barrier_gradient(double mu, double* out) const {
        for (int k = 0; k < count; ++k)
            out[k] += mu / (upper[k] - value[k]) - mu / (value[k] - lower[k]);
    }
    void add_multipliers(double* out) const {
        for (int k = 0; k < count; ++k) out[k] += zu[k] - zl[k];
    }
    void multiplier_steps(double mu) {
        for (int k = 0; k < count; ++k) {
            const double below = value[k] - lower[k], above = upper[k] - value[k];
            dzl[k] = (mu - zl[k] * step[k]) / below - zl[k];
            dzu[k] = (mu + zu[k] * step[k]) / above - zu[k];
        }
    }
    double longest_primal(double tau, double at_most) const {
        for (int k = 0; k < count; ++k) {
            const double room = step[k] < 0.0 ? value[k] - lower[k] : upper[k] - value[k];
            at_most = std::min(at_most, tau * room / std::abs(step[k] == 0.0 ? 1e-300 : step[k]));
        }
        return at_most;
    }
    double longest_dual(double tau, double at_most) const {
        for (int k = 0; k < count; ++k) {
            if (dzl[k] < 0.0) at_most = std::min(at_most, -tau * zl[k] / dzl[k]);
            if (dzu[k] < 0.0) at_most = std::min(at_most, -tau * zu[k] / dzu[k]);
        }
        return at_most;
    }
    // Multipliers move, then stay within κ of the central path's.
    void move_multipliers(double alpha, double mu) {
        constexpr double kappa = 1e10;
        for (int k = 0; k < count; ++k) {
            const double below = mu / (value[k] - lower[k]), above = mu / (upper[k] - value[k]);
            zl[k] = std::clamp(zl[k] + alpha * dzl[k], below / kappa, kappa * below);
            zu[k] = std::clamp(zu[k] + alpha * dzu[k], above / kappa, kappa * above);
        }
    }
    // Σ log of the distances at `at`; −inf outside.
    double log_distances(const double* at) const {
        double sum = 0.0, product = 1.0;
        for (int k = 0; k < count; ++k) {
            const double below = at[k] - lower[k], above = upper[k] - at[k];
            if (!(below > 0.0) || !(above > 0.0)) return -std::numeric_limits<double>::infinity();
            product *= (std::isfinite(below) ? below : 1.0) * (std::isfinite(above) ? above : 1.0);
            if (k % 4 == 3) sum += std::log(product), product = 1.0;
        }
        return sum + std::log(product);
    }
    // Largest |z (v − bound) − μ|.
    double complementarity(double mu) const {
        double most = 0.0;
        for (int k = 0; k < count; ++k) {
            if (std::isfinite(lower[k]))
                most = std::max(most, std::abs(zl[k] * (value[k] - lower[k]) - mu));
            if (std::isfinite(upper[k]))
                most = std::max(most, std::abs(zu[k] * (upper[k] - value[k]) - mu));
        }
        return most;
    }
    double multiplier_sum() const {
        double sum = 0.0;
        for (int k = 0; k < count; ++k) sum += zl[k] + zu[k];
        return sum;
    }
};

}  // namespace skyknot::inline SKYKNOT_ISA
