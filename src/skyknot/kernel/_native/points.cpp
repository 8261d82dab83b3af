#include "points.hpp"

#include <algorithm>

#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

constexpr int lanes = 16;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

inline void add_scaled(double* out, const double* in, double factor, int count) {
    for (int k = 0; k < count; ++k) out[k] += factor * in[k];
}

}  // namespace

Points::Points(const Structure& structure, const Tape& value, const Tape& full)
    : length(structure, 1 + static_cast<int>(structure.rates.size())),
      parameters(at(structure.np)),
      S_(structure),
      value_(value),
      full_(full),
      value_workspace_(make_workspace(value.workspace_size(lanes))),
      full_workspace_(make_workspace(full.workspace_size(lanes))),
      gradient_(make_workspace(at(8 * structure.ny()))),
      step_(S_, PointProducts::Of::step),
      adjoint_(S_, PointProducts::Of::adjoint),
      path_step_(S_, PointProducts::Of::path_step),
      path_adjoint_(S_, PointProducts::Of::path_adjoint) {
    for (int c = 0; c < S_.classes(); ++c) {
        rows.emplace_back(S_, S_.class_rows());
        time.emplace_back(S_, 1);
        cost.emplace_back(S_, 1);
    }
    value_.prepare<lanes>(value_workspace_.get());
    full_.prepare<lanes>(full_workspace_.get());
}

const double* Points::state(int c, const RowBuffer& v, int i) const {
    const int point = S_.used[at(c)];
    return point == S_.s - 1 ? v.row(S_.state_row(0, i)) + 1 : v.row(S_.state_row(point, i));
}

void Points::gather(int c, int first, const RowBuffer& v, const double* q, double* to,
                    int stride) const {
    for (int i = 0; i < S_.nx; ++i, to += stride) store8(to, load8(state(c, v, i) + first));
    for (int i = 0; i < S_.nu; ++i, to += stride) {
        Vector8 u{};
        for (int m = 0; m < S_.m; ++m) {
            const double weight = S_.W[at(c * S_.m + m)];
            if (weight == 0.0) continue;
            const bool next = S_.shared && m == S_.m - 1;
            u += weight * load8(v.row(S_.control_row(next ? 0 : m, i)) + (next ? 1 : 0) + first);
        }
        store8(to, u);
    }
    for (int i = 0; i < S_.nq; ++i, to += stride) store8(to, broadcast8(q[i]));
}

// ν = Σ_i δ A_ij λ_i; at a shared node, the segment behind has its part.
void Points::gather_multipliers(int c, int first, const RowBuffer& lambda, double* to,
                                int stride) const {
    const int n = static_cast<int>(S_.used.size());
    const double* h = length.row(0) + first;
    for (int r = 0; r < S_.nx; ++r, to += stride) {
        Vector8 nu{};
        for (int i = 0; i < S_.s - 1; ++i) {
            const double* l = lambda.row(i * S_.nx + r) + first;
            if (const double a = S_.A[at(i * n + c)]; a != 0.0) nu += a * load8(h) * load8(l);
            if (!S_.shared || c != 0) continue;
            if (const double a = S_.A[at(i * n + n - 1)]; a != 0.0)
                nu += a * load8(h - 1) * load8(l - 1);
        }
        store8(to, nu);
    }
}

void Points::run(const Tape& tape, double* w, int c, const RowBuffer& z, const double* q,
                 const RowBuffer* lambda, const RowBuffer* y) {
    const int count = S_.class_count(c);
    for (int first = 0; first < count; first += lanes) {
        for (int half = 0; half < lanes; half += 8) {
            gather(c, first + half, z, q, w + half, lanes);
            double* slot = w + S_.ny() * lanes + half;
            store8(slot, load8(time[at(c)].row(0) + first + half));
            for (const double p : parameters) store8(slot += lanes, broadcast8(p));
            if (lambda == nullptr) continue;
            store8(slot += lanes, load8(cost[at(c)].row(0) + first + half));
            gather_multipliers(c, first + half, *lambda, slot += lanes, lanes);
            slot += (S_.nx - 1) * lanes;
            for (int i = 0; i < S_.ng; ++i) store8(slot += lanes, load8(y->row(i) + first + half));
        }
        tape.run<lanes>(w);
        double *low = rows[at(c)].block(first), *high = rows[at(c)].block(first + 8);
        for (std::size_t o = 0; o < tape.outputs(); ++o) {
            const double* from = w + std::size_t{tape.output_slot(o)} * lanes;
            store8(low + 8 * o, load8(from)), store8(high + 8 * o, load8(from + 8));
        }
    }
}

void Points::evaluate(const RowBuffer& z, const double* q) {
    ++value_runs;
    for (int c = 0; c < S_.classes(); ++c)
        run(value_, value_workspace_.get(), c, z, q, nullptr, nullptr);
}

void Points::differentiate(const RowBuffer& z, const double* q, const RowBuffer& lambda,
                           const std::vector<const RowBuffer*>& y) {
    ++full_runs;
    for (int c = 0; c < S_.classes(); ++c)
        run(full_, full_workspace_.get(), c, z, q, &lambda, y[at(c)]);
}

void Points::clear_hessian() {
    for (BlockRows& each : rows) each.clear(S_.row_H(), static_cast<int>(S_.H.size()));
}

double Points::cost_sum() const {
    double sum = 0.0;
    for (int c = 0; c < S_.classes(); ++c)
        for (int first = 0; first < S_.class_count(c); first += 8) {
            const double* L = rows[at(c)].block(first) + 8 * S_.row_L();
            const double* weight = cost[at(c)].row(0) + first;
            const int count = std::min(8, S_.class_count(c) - first);
            for (int k = 0; k < count; ++k) sum += weight[k] * L[k];
        }
    return sum;
}

void Points::defects(const RowBuffer& z, RowBuffer& d) const {
    combine(z, rows, S_.row_F(), nullptr, d);
}

void Points::combine(const RowBuffer& v, const std::vector<BlockRows>& F, int first_row,
                     const RowBuffer* base, RowBuffer& d) const {
    const int n = static_cast<int>(S_.used.size());
    for (int first = 0; first < S_.N; first += 8)
        for (int i = 0; i < S_.s - 1; ++i)
            for (int r = 0; r < S_.nx; ++r) {
                Vector8 sum{};
                for (int c = 0; c < n; ++c) {
                    const double a = S_.A[at(i * n + c)];
                    if (a == 0.0) continue;
                    const bool next = S_.shared && c == S_.classes();
                    const BlockRows& from = F[at(next ? 0 : c)];
                    const double* f = from.block(first) + 8 * (first_row + r);
                    sum += a * (next ? load_next(f, from.stride()) : load8(f));
                }
                sum = sum * load8(length.row(0) + first);
                if (base != nullptr) sum += load8(base->row(i * S_.nx + r) + first);
                for (int j = 0; j < S_.s; ++j) {
                    const double weight = S_.C[at(i * S_.s + j)];
                    if (weight == 0.0) continue;
                    const bool last = j == S_.s - 1;
                    const double* x = v.row(S_.state_row(last ? 0 : j, r)) + (last ? 1 : 0);
                    sum += weight * load8(x + first);
                }
                store8(d.row(i * S_.nx + r) + first, sum);
            }
}

// Calls block(first, class rows) for every eight points of a class.
template <class Block>
void Points::for_blocks(int c, Block block) {
    for (int first = 0; first < S_.class_count(c); first += 8) block(first, rows[at(c)].block(first));
}

template <class Row>
void Points::scatter(int c, int first, Row row, RowBuffer& v, double* globals) const {
    // lanes from here on are no points
    const Vector8 past = broadcast8(S_.class_count(c) - first);
    static constexpr double numbers[] = {0, 1, 2, 3, 4, 5, 6, 7};
    const Bits<8> inside = load8(numbers) < past;
    const int point = S_.used[at(c)];
    const int shift = point == S_.s - 1 ? 1 : 0;
    const auto given = [&](int i) SKYKNOT_LAMBDA {
        return select(inside, load8(row(i)), Vector8{});
    };
    const auto add = [&](double* to, const Vector8& value) SKYKNOT_LAMBDA {
        store8(to + first, load8(to + first) + value);
    };
    for (int i = 0; i < S_.nx; ++i) add(v.row(S_.state_row(shift ? 0 : point, i)) + shift, given(i));
    for (int m = 0; m < S_.m; ++m) {
        const double weight = S_.W[at(c * S_.m + m)];
        const bool next = S_.shared && m == S_.m - 1;
        for (int i = 0; weight != 0.0 && i < S_.nu; ++i)
            add(v.row(S_.control_row(next ? 0 : m, i)) + (next ? 1 : 0), weight * given(S_.nx + i));
    }
    for (int i = 0; i < S_.nq; ++i) globals[i] += sum8(given(S_.nx + S_.nu + i));
}

void Points::add_cost_gradient(RowBuffer& v, double* globals) {
    for (int c = 0; c < S_.classes(); ++c)
        for_blocks(c, [&](int first, const double* class_rows) {
            const Vector8 weight = load8(cost[at(c)].row(0) + first);
            const double* slope = class_rows + 8 * S_.row_gradient();
            for (const int i : S_.gradient) {
                store8(gradient_.get() + 8 * i, weight * load8(slope));
                slope += 8;
            }
            scatter(c, first, [&](int i) { return gradient_.get() + 8 * i; }, v, globals);
        });
}

void Points::load_rows(const RowBuffer& from, int first, double* to) const {
    for (int i = 0; i < from.rows(); ++i) store8(to + 8 * i, load8(from.row(i) + first));
}

void Points::add_adjoint(const RowBuffer& lambda, const std::vector<const RowBuffer*>& y,
                         RowBuffer& v, double* globals) {
    if (y.empty()) std::fill_n(adjoint_.t(), 8 * S_.ng, 0.0);
    for (int c = 0; c < S_.classes(); ++c)
        for_blocks(c, [&](int first, const double* class_rows) {
            gather_multipliers(c, first, lambda, adjoint_.nu(), 8);
            if (!y.empty()) load_rows(*y[at(c)], first, adjoint_.t());
            adjoint_.run(class_rows);
            scatter(c, first, [&](int i) { return adjoint_.out(i); }, v, globals);
        });
    add_C_transposed(lambda, v);
}

void Points::add_path_adjoint(int c, const RowBuffer& t, RowBuffer& v, double* globals) {
    if (S_.ng == 0) return;
    for_blocks(c, [&](int first, const double* class_rows) {
        load_rows(t, first, path_adjoint_.t());
        path_adjoint_.run(class_rows);
        scatter(c, first, [&](int i) { return path_adjoint_.out(i); }, v, globals);
    });
}

void Points::path_products(int c, const RowBuffer& step, const double* step_q, RowBuffer& out) {
    if (S_.ng == 0) return;
    for_blocks(c, [&](int first, const double* class_rows) {
        gather(c, first, step, step_q, path_step_.y(), 8);
        path_step_.run(class_rows);
        for (int i = 0; i < S_.ng; ++i) store8(out.row(i) + first, load8(path_step_.path(i)));
    });
}

void Points::add_products(int c, const RowBuffer& step, const double* step_q, const RowBuffer& lambda,
                          const PathRows& path, BlockRows& F, RowBuffer& v, double* globals) {
    for_blocks(c, [&](int first, const double* class_rows) {
        gather(c, first, step, step_q, step_.y(), 8);
        gather_multipliers(c, first, lambda, step_.nu(), 8);
        load_rows(path.multiplier, first, step_.t());
        load_rows(path.weight, first, step_.weight());
        step_.run(class_rows);
        for (int i = 0; i < S_.nx; ++i) store8(F.block(first) + 8 * i, load8(step_.rates(i)));
        for (int i = 0; i < S_.ng; ++i) store8(path.linear.row(i) + first, load8(step_.path(i)));
        scatter(c, first, [&](int i) { return step_.out(i); }, v, globals);
    });
}

void Points::add_C_transposed(const RowBuffer& lambda, RowBuffer& v) const {
    for (int i = 0; i < S_.s - 1; ++i)
        for (int j = 0; j < S_.s; ++j) {
            const double weight = S_.C[at(i * S_.s + j)];
            if (weight == 0.0) continue;
            const bool last = j == S_.s - 1;
            for (int r = 0; r < S_.nx; ++r)
                add_scaled(v.row(S_.state_row(last ? 0 : j, r)) + (last ? 1 : 0),
                           lambda.row(i * S_.nx + r), weight, S_.N);
        }
}

// Row of V that control value m of a rate row reads, and its shift.
std::pair<int, int> Points::rate_place(const RateRow& row, int m) const {
    if (S_.carry) return {S_.control_row(0, row.control), m - 1};
    const bool next = S_.shared && m == S_.m - 1;
    return {S_.control_row(next ? 0 : m, row.control), next ? 1 : 0};
}

void Points::rates(const RowBuffer& v, const double* q, RowBuffer& out) const {
    for (std::size_t r = 0; r < S_.rates.size(); ++r) {
        const RateRow& row = S_.rates[r];
        double* to = out.row(static_cast<int>(r));
        std::fill_n(to, S_.N, 0.0);
        for (std::size_t m = 0; m < row.weights.size(); ++m) {
            const auto [place, shift] = rate_place(row, static_cast<int>(m));
            add_scaled(to, v.row(place) + shift, row.weights[m], S_.N);
        }
        if (S_.free_duration) add_scaled(to, length.row(1 + static_cast<int>(r)), q[0], S_.N);
        if (S_.carry) to[0] = 0.0;  // the first control has no previous one
    }
}

void Points::add_rates_transposed(const RowBuffer& t, RowBuffer& v, double* globals) const {
    for (std::size_t r = 0; r < S_.rates.size(); ++r) {
        const RateRow& row = S_.rates[r];
        const double* from = t.row(static_cast<int>(r));
        const int first = S_.carry ? 1 : 0;
        for (std::size_t m = 0; m < row.weights.size(); ++m) {
            const auto [place, shift] = rate_place(row, static_cast<int>(m));
            add_scaled(v.row(place) + shift + first, from + first, row.weights[m], S_.N - first);
        }
        if (S_.free_duration) {
            const double* a = length.row(1 + static_cast<int>(r));
            for (int k = first; k < S_.N; ++k) globals[0] += a[k] * from[k];
        }
    }
}

}  // namespace skyknot::inline SKYKNOT_ISA
