// Assembly and factorisation of the Newton system.
#include <algorithm>
#include <cmath>

#include "newton.hpp"
#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

// The terminal tape reads (x, q, p) and gives M, its gradient over (x, q) and its dense Hessian.
void Newton::evaluate_terminal(const RowBuffer& z, const double* q, double scale) {
    double* w = terminal_workspace_.get();
    const int n = S_.nx + S_.nq;
    for (int i = 0; i < n; ++i)
        store8(w + 8 * i,
               broadcast8(i < S_.nx ? z.row(S_.state_row(0, i))[S_.N] : q[i - S_.nx]));
    for (int i = 0; i < S_.np; ++i)
        store8(w + 8 * (n + i), broadcast8(points_.parameters[at(i)]));
    terminal_.run<8>(w);
    const auto read = [&](std::size_t o) { return scale * w[terminal_.output_slot(o) * 8]; };
    terminal_value = read(0);
    for (int i = 0; i < n; ++i) terminal_gradient[at(i)] = read(at(1 + i));
    for (int i = 0; i < n * n; ++i) terminal_hessian_[at(i)] = read(at(1 + n + i));
}

bool Newton::factor() {
    ++factorisations;
    weighted_ = false;
    for (Group& group : groups)
        for (int r = 0; r < group.weight.rows(); ++r)
            for (int k = 0; k <= S_.N; ++k) {
                group.total.row(r)[k] = group.weight.row(r)[k] + group.equality.row(r)[k];
                weighted_ = weighted_ || group.equality.row(r)[k] > 0.0;
            }
    if (S_.carry)
        for (int r = 0; r < groups.back().total.rows(); ++r) groups.back().total.row(r)[0] = 0.0;
    for (const Pin& pin : pins) weight_v.row(pin.row)[pin.k] += pin_weight;

    std::vector<const double*>& sources = factor_sources_;
    sources[source::fixed] = points_.length.origin();
    sources[source::weight_v] = weight_v.origin();
    sources[source::weight_r] = groups.back().total.origin();
    for (int c = 0; c < S_.classes(); ++c) {
        sources[source::first_class + 2 * at(c) + 1] = groups[at(c)].total.origin();
    }
    fill_terminal();
    const bool definite = factor_blocks(sources);
    for (const Pin& pin : pins) weight_v.row(pin.row)[pin.k] -= pin_weight;
    return definite && riccati_.factor_first() && factor_border();
}

// Eliminates eight segments, factors their stages, and goes on towards the start; an indefinite
// stage ends it at once.
bool Newton::factor_blocks(std::vector<const double*>& sources) {
    const double scalars[] = {regularisation, elastic_weight};
    const StageLayout& layout = riccati_.layout();
    for (int first = (S_.N - 1) / lane_count * lane_count; first >= 0; first -= lane_count) {
        double* const targets[] = {segment_block(first), nullptr, nullptr};
        for (int c = 0; c < S_.classes(); ++c)
            sources[source::first_class + 2 * at(c)] = points_.rows[at(c)].block(first) - first;
        const int filled = std::min(lane_count, S_.N - first);
        const Blocks blocks[] = {{riccati_.stage(first), layout.size()},
                                 {riccati_.hessian(first), layout.hessian_size()}};
        elimination_.factor.run({.sources = sources.data(),
                                 .targets = targets,
                                 .scalars = scalars,
                                 .first = first,
                                 .workspace = factor_workspace_.get(),
                                 .blocks = blocks,
                                 .filled = filled});
        for (int k = first + filled - 1; k >= first; --k)
            if (!riccati_.factor_stage(k)) {
                riccati_.failed_stage = k;
                return false;
            }
    }
    return true;
}

// Hessian of the last node: terminal cost, its own point when controls are shared, and the weights
// of bounds and pins, which stand in `weight_v`.
void Newton::fill_terminal() {
    const StageLayout& layout = riccati_.layout();
    double* P = riccati_.terminal();
    std::fill_n(P, at(layout.sp * layout.ns), 0.0);
    std::fill(terminal_q_.begin(), terminal_q_.end(), 0.0);
    const int n = S_.nx + S_.nq, sp = layout.sp;
    const int own = S_.nx + (S_.shared ? S_.nu : 0);
    const auto q_of = [&](int y) { return y - S_.nx - S_.nu; };
    std::vector<double>& schur = schur_;
    std::fill(schur.begin(), schur.end(), 0.0);
    const auto add = [&](int a, int b, double value) {  // over (x, u, q)
        if (a < own && b < own) P[b * sp + a] += value;
        else if (a < own) terminal_q_[at(q_of(b) * sp + a)] += value;
        else if (a >= S_.nx + S_.nu && b >= S_.nx + S_.nu)
            schur[at(q_of(a) * S_.nq + q_of(b))] += value;
    };
    const auto from_terminal = [&](int i) { return i < S_.nx ? i : i + S_.nu; };
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b)
            add(from_terminal(a), from_terminal(b), terminal_hessian_[at(a * n + b)]);
    if (S_.shared) visit_node_hessian(S_.N, add);
    for (int i = 0; i < S_.nx; ++i)
        P[i * sp + i] += weight_v.row(S_.state_row(0, i))[S_.N] + regularisation;
    if (S_.shared)
        for (int i = 0; i < S_.nu; ++i)
            P[(S_.nx + i) * sp + S_.nx + i] +=
                weight_v.row(S_.control_row(0, i))[S_.N] + regularisation;
}

// Columns of the globals, and the Schur complement they leave.
bool Newton::factor_border() {
    const StageLayout& layout = riccati_.layout();
    const int nq = S_.nq;
    for (int q = 0; q < nq; ++q) {
        Riccati::RightSide& right = border_[at(q)];
        for (int k = 0; k < S_.N; ++k) {
            const double* stage = riccati_.stage(k);
            double* to = right.stages.get() + at(k) * layout.vector_size();
            std::copy_n(stage + layout.gq(0, q), at(layout.wp), to);
            std::copy_n(stage + layout.rq(0, q), at(S_.nx), to + layout.r(0));
        }
        std::copy_n(terminal_q_.data() + at(q * layout.sp), at(layout.sp), right.terminal.get());
        riccati_.backward(right);
        riccati_.forward(right);
    }
    for (int a = 0; a < nq; ++a) {
        for (int b = 0; b < nq; ++b) {
            for (int k = 0; k < S_.N; ++k) schur_[at(a * nq + b)] += riccati_.stage(k)[layout.Hqq(a, b)];
            schur_[at(a * nq + b)] += border_product(border_[at(b)], a);
        }
        schur_[at(a * nq + a)] += weight_q[at(a)] + regularisation;
    }
    for (int j = 0; j < nq; ++j)  // Cholesky in place
        for (int i = j; i < nq; ++i) {
            double sum = schur_[at(i * nq + j)];
            for (int l = 0; l < j; ++l) sum -= schur_[at(i * nq + l)] * schur_[at(j * nq + l)];
            if (i == j && (!(sum > 0.0) || !std::isfinite(sum))) return false;
            schur_[at(i * nq + j)] = i == j ? std::sqrt(sum) : sum / schur_[at(j * nq + j)];
        }
    return true;
}

// g_qᵀ w + r_qᵀ π summed over the stages: how a solution acts on the globals' equation.
double Newton::border_product(const Riccati::RightSide& right, int q) const {
    const StageLayout& layout = riccati_.layout();
    double sum = 0.0;
    for (int k = 0; k < S_.N; ++k) {
        const double* stage = riccati_.stage(k);
        const double* w = right.w.get() + k * layout.wp;
        const double* costate = right.costate.get() + (k + 1) * layout.sp;
        for (int i = 0; i < layout.wp; ++i) sum += stage[layout.gq(i, q)] * w[i];
        for (int i = 0; i < S_.nx; ++i) sum += stage[layout.rq(i, q)] * costate[i];
    }
    for (int i = 0; i < layout.ns; ++i) sum += terminal_q_[at(q * layout.sp + i)] * right.last[at(i)];
    return sum;
}

}  // namespace skyknot::inline SKYKNOT_ISA
