#include "riccati.hpp"

#include <algorithm>
#include <cmath>

#include "cholesky.hpp"
#include "small_matrix.hpp"
#include "transpose.hpp"

namespace skyknot::inline SKYKNOT_ISA {

namespace {
std::size_t size(int a, int b = 1) { return static_cast<std::size_t>(a) * static_cast<std::size_t>(b); }

// Writes the transpose of an eight by eight block; only its first `columns` columns exist.
void mirror(const double* from, double* to, int stride, int columns) {
    turn_block([=](int j) { return from + j * stride; },
               [=](int j) { return j < columns ? to + j * stride : nullptr; });
}
}  // namespace

Riccati::Riccati(const Structure& structure, bool elastic)
    : fixed_first(size(structure.ns()), 0),
      structure_(structure),
      layout_(structure, elastic),
      N_(structure.N),
      stages_(make_workspace(size(N_) * layout_.size())),
      hessians_(make_workspace(8 * layout_.hessian_size())),
      P_(make_workspace(size(N_ + 1) * size(layout_.sp, layout_.ns))),
      L_(make_workspace(size(N_) * size(layout_.wp, layout_.nv))),
      inverse_(make_workspace(8 * size(N_, layout_.vp))),
      carry_(make_workspace(size(layout_.ns - layout_.nx, layout_.wp))),
      M_(make_workspace(size(layout_.sp, layout_.wp))),
      first_(size(layout_.ns, layout_.ns)) {
    free_.reserve(size(layout_.ns));
    for (int i = 0; i < layout_.ns - layout_.nx; ++i)
        carry_[size(i * layout_.wp + structure_.v_carried(i))] = 1.0;
}

bool Riccati::factor_stage(int k) {
    const auto [nx, nq, ns, nv, vp, sp, wp] = layout_;
    const double* H = hessian(k);
    const double* A = stage(k) + layout_.A(0, 0);
    const double* next = P(k + 1);
    double* M = M_.get();
    const int carried = ns - nx;

    // M = P [A; carry]
    multiply({}, {next, sp, A, wp, 1, nx}, {}, M, sp, sp, nv);
    multiply({}, {next, sp, A + vp, wp, 1, nx}, {}, M + vp * sp, sp, sp, ns);
    for (int i = 0; i < carried; ++i) {
        double* column = M + structure_.v_carried(i) * sp;
        const double* from = next + (nx + i) * sp;
        for (int r = 0; r < sp; ++r) column[r] += from[r];
    }
    // v columns of C, all rows, then their Cholesky factor in place
    double* Lk = L(k);
    multiply({H, wp}, {A, wp, M, 1, sp, nx}, {}, Lk, wp, wp, nv);
    if (carried > 0) multiply({Lk, wp}, {carry_.get(), wp, M + nx, 1, sp, carried}, {}, Lk, wp, vp, nv);
    double pivots[8];  // 1 / L_ii
    for (int p = 0; p < nv; p += 8) {
        double* panel = Lk + p * wp + p;
        const int rows = wp - p, count = std::min(8, nv - p);
        if (p > 0) multiply({panel, wp}, {}, {Lk + p, wp, Lk + p, wp, 1, p}, panel, wp, rows, count);
        if (!factor_panel(panel, wp, rows, count, pivots)) return false;
        invert_rows(panel, wp, count, pivots, inverse(k) + 8 * p);
        for (int j = 0; j < count; ++j) std::fill_n(Lk + (p + j) * wp, p, 0.0);
    }
    // P = C_ss − L_sv L_svᵀ: eight columns from their diagonal block down, mirrored to the right
    double* here = P(k);
    for (int c = 0; c < sp; c += 8) {
        const int count = std::min(8, ns - c), rows = sp - c;
        double* corner = here + c * sp + c;
        multiply({H + layout_.H(vp + c, vp + c), wp}, {A + vp + c, wp, M + (vp + c) * sp, 1, sp, nx},
                 {Lk + vp + c, wp, Lk + vp + c, wp, 1, nv}, corner, sp, rows, count);
        for (int r = 8; r < rows; r += 8) mirror(corner + r, corner + r * sp, sp, std::min(8, ns - c - r));
    }
    return true;
}

bool Riccati::factor_first() {
    free_.clear();
    for (int i = 0; i < layout_.ns; ++i)
        if (!fixed_first[size(i)]) free_.push_back(i);
    const int n = static_cast<int>(free_.size());
    const double* P0 = P(0);
    for (int j = 0; j < n; ++j)
        for (int i = j; i < n; ++i) {
            double sum = P0[free_[size(j)] * layout_.sp + free_[size(i)]];
            for (int l = 0; l < j; ++l) sum -= first_[size(i * n + l)] * first_[size(j * n + l)];
            if (i == j) {
                if (!(sum > 0.0) || !std::isfinite(sum)) return false;
                first_[size(j * n + j)] = std::sqrt(sum);
            } else {
                first_[size(i * n + j)] = sum / first_[size(j * n + j)];
            }
        }
    return true;
}

Riccati::RightSide Riccati::right_side() const {
    return {make_workspace(size(N_) * layout_.vector_size()),
            make_workspace(size(layout_.sp)),
            make_workspace(size(N_ + 1, layout_.sp)),
            make_workspace(size(N_, layout_.vp)),
            make_workspace(size(N_, layout_.wp)),
            make_workspace(size(layout_.sp)),
            make_workspace(size(N_ + 1, layout_.sp))};
}

void Riccati::backward(RightSide& right) const {
    const auto [nx, nq, ns, nv, vp, sp, wp] = layout_;
    copy8(right.terminal.get(), right.p.get() + N_ * sp, sp);
    double* t = right.last.get();
    for (int k = N_ - 1; k >= 0; --k) {
        double* g = right.stages.get() + size(k) * layout_.vector_size();
        const double* r = g + wp;
        const double* A = stage(k) + layout_.A(0, 0);
        multiply_vector(right.p.get() + (k + 1) * sp, P(k + 1), sp, r, t, sp, nx);
        // the right-hand side itself must survive refinement: work on a copy in w
        double* work = right.w.get() + k * wp;
        multiply_vector(g, A, wp, t, work, wp, nx);
        if (ns > nx) multiply_vector(work, carry_.get(), wp, t + nx, work, vp, ns - nx);
        double* y = right.y.get() + k * vp;
        for (int p = 0; p < vp; p += 8) {
            const double* W = inverse(k) + 8 * p;
            const auto row = [=](int j) { return W + 8 * j; };
            row_products(nullptr, row, 8, work + p, 8, y + p);
            const double* below = L(k) + p * wp + p + 8;
            multiply_vector(work + p + 8, below, wp, y + p, work + p + 8, wp - p - 8,
                            std::min(8, nv - p), -1.0);
        }
        copy8(work + vp, right.p.get() + k * sp, sp);
    }
}

void Riccati::forward(RightSide& right) const {
    const auto [nx, nq, ns, nv, vp, sp, wp] = layout_;
    const int n = static_cast<int>(free_.size());
    double* s = right.last.get();
    std::fill_n(s, sp, 0.0);
    const double* p0 = right.p.get();
    for (int i = 0; i < n; ++i) {
        double sum = -p0[free_[size(i)]];
        for (int l = 0; l < i; ++l) sum -= first_[size(i * n + l)] * s[free_[size(l)]];
        s[free_[size(i)]] = sum / first_[size(i * n + i)];
    }
    for (int i = n - 1; i >= 0; --i) {
        double sum = s[free_[size(i)]];
        for (int l = i + 1; l < n; ++l) sum -= first_[size(l * n + i)] * s[free_[size(l)]];
        s[free_[size(i)]] = sum / first_[size(i * n + i)];
    }
    for (int k = 0; k <= N_; ++k) {
        double* costate = right.costate.get() + k * sp;
        multiply_vector(right.p.get() + k * sp, P(k), sp, s, costate, sp, ns);
        if (k == N_) break;
        double* w = right.w.get() + k * wp;
        copy8(s, w + vp, sp);
        for (int p = vp - 8; p >= 0; p -= 8) {
            const double* columns = L(k) + p * wp + p + 8;
            const auto column = [=](int j) { return columns + j * wp; };
            double sum[8], zero[8] = {};
            row_products(right.y.get() + k * vp + p, column, std::min(8, nv - p), w + p + 8, wp - p - 8,
                         sum);
            multiply_vector(zero, inverse(k) + 8 * p, 8, sum, w + p, 8, 8, -1.0);
        }
        const double* A = stage(k) + layout_.A(0, 0);
        const double* r = right.stages.get() + size(k) * layout_.vector_size() + wp;
        for (int i = 0; i < sp; i += 8) {
            const auto row = [&](int j) {
                return i + j < nx ? A + (i + j) * wp : carry_.get() + (i + j - nx) * wp;
            };
            row_products(i < nx ? r + i : nullptr, row, std::min(8, ns - i), w, wp, s + i);
        }
    }
}

}  // namespace skyknot::inline SKYKNOT_ISA
