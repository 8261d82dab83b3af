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
inline void add_product(double* out, const double* a, const double* b, int count) {
    for (int k = 0; k < count; ++k) out[k] += a[k] * b[k];
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
      nu_(structure, structure.nx) {
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

void Points::run(const Tape& tape, double* w, int c, const RowBuffer& z, const double* q,
                 const RowBuffer* nu, const RowBuffer* y) {
    const int count = S_.class_count(c);
    RowBuffer& out = rows[at(c)];
    for (int first = 0; first < count; first += lanes) {
        double* slot = w;
        const auto put = [&](const double* row) {
            store8(slot, load8(row + first));
            store8(slot + 8, load8(row + first + 8));
            slot += lanes;
        };
        for (int i = 0; i < S_.nx; ++i) put(state(c, z, i));
        for (int i = 0; i < S_.nu; ++i) {
            Vector8 low{}, high{};
            for (int m = 0; m < S_.m; ++m) {
                const double weight = S_.W[at(c * S_.m + m)];
                if (weight == 0.0) continue;
                const bool next = S_.shared && m == S_.m - 1;
                const double* row = z.row(S_.control_row(next ? 0 : m, i)) + (next ? 1 : 0) + first;
                low += weight * load8(row);
                high += weight * load8(row + 8);
            }
            store8(slot, low), store8(slot + 8, high);
            slot += lanes;
        }
        const auto spread = [&](double value) {
            store8(slot, broadcast8(value)), store8(slot + 8, broadcast8(value));
            slot += lanes;
        };
        for (int i = 0; i < S_.nq; ++i) spread(q[i]);
        put(time[at(c)].row(0));
        for (const double p : parameters) spread(p);
        if (nu != nullptr) {
            put(cost[at(c)].row(0));
            for (int i = 0; i < S_.nx; ++i) put(nu->row(i));
            for (int i = 0; i < S_.ng; ++i) put(y->row(i));
        }
        tape.run<lanes>(w);
        const int filled = std::min(lanes, count - first);
        for (std::size_t o = 0; o < tape.outputs(); ++o) {
            const double* from = w + std::size_t{tape.output_slot(o)} * lanes;
            double* to = out.row(static_cast<int>(o)) + first;
            store8(to, load8(from));
            if (filled > 8) store8(to + 8, load8(from + 8));
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
    for (int c = 0; c < S_.classes(); ++c) {
        spread_multipliers(c, lambda, nu_);
        run(full_, full_workspace_.get(), c, z, q, &nu_, y[at(c)]);
    }
}

double Points::cost_sum() const {
    double sum = 0.0;
    for (int c = 0; c < S_.classes(); ++c) {
        const double* L = rows[at(c)].row(S_.row_L());
        const double* weight = cost[at(c)].row(0);
        for (int k = 0; k < S_.class_count(c); ++k) sum += weight[k] * L[k];
    }
    return sum;
}

void Points::defects(const RowBuffer& z, RowBuffer& d) const {
    combine(z, rows, S_.row_F(), d);
}

void Points::combine(const RowBuffer& v, const std::vector<RowBuffer>& F, int first_row,
                     RowBuffer& d) const {
    const int n = static_cast<int>(S_.used.size());
    const double* h = length.row(0);
    for (int i = 0; i < S_.s - 1; ++i)
        for (int r = 0; r < S_.nx; ++r) {
            double* out = d.row(i * S_.nx + r);
            std::fill_n(out, S_.N, 0.0);
            for (int c = 0; c < n; ++c) {
                const double a = S_.A[at(i * n + c)];
                if (a == 0.0) continue;
                const bool next = S_.shared && c == S_.classes();
                const double* f = F[at(next ? 0 : c)].row(first_row + r) + (next ? 1 : 0);
                add_scaled(out, f, a, S_.N);
            }
            for (int k = 0; k < S_.N; ++k) out[k] *= h[k];
            for (int j = 0; j < S_.s; ++j) {
                const double weight = S_.C[at(i * S_.s + j)];
                if (weight == 0.0) continue;
                const bool last = j == S_.s - 1;
                add_scaled(out, v.row(S_.state_row(last ? 0 : j, r)) + (last ? 1 : 0), weight,
                           S_.N);
            }
        }
}

void Points::gather(int c, const RowBuffer& v, const double* q, RowBuffer& out) const {
    const int count = S_.class_count(c);
    for (int i = 0; i < S_.nx; ++i) std::copy_n(state(c, v, i), count, out.row(i));
    for (int i = 0; i < S_.nu; ++i) {
        double* u = out.row(S_.nx + i);
        std::fill_n(u, count, 0.0);
        for (int m = 0; m < S_.m; ++m) {
            const double weight = S_.W[at(c * S_.m + m)];
            const bool next = S_.shared && m == S_.m - 1;
            if (weight != 0.0)
                add_scaled(u, v.row(S_.control_row(next ? 0 : m, i)) + (next ? 1 : 0), weight,
                           count);
        }
    }
    for (int i = 0; i < S_.nq; ++i) std::fill_n(out.row(S_.nx + S_.nu + i), count, q[i]);
}

void Points::scatter(int c, const RowBuffer& in, RowBuffer& v, double* globals) const {
    const int count = S_.class_count(c);
    const int point = S_.used[at(c)];
    const bool at_next = point == S_.s - 1;
    for (int i = 0; i < S_.nx; ++i)
        add_scaled(v.row(S_.state_row(at_next ? 0 : point, i)) + (at_next ? 1 : 0), in.row(i), 1.0,
                   count);
    for (int i = 0; i < S_.nu; ++i)
        for (int m = 0; m < S_.m; ++m) {
            const double weight = S_.W[at(c * S_.m + m)];
            const bool next = S_.shared && m == S_.m - 1;
            if (weight != 0.0)
                add_scaled(v.row(S_.control_row(next ? 0 : m, i)) + (next ? 1 : 0),
                           in.row(S_.nx + i), weight, count);
        }
    for (int i = 0; i < S_.nq; ++i) {
        const double* row = in.row(S_.nx + S_.nu + i);
        for (int k = 0; k < count; ++k) globals[i] += row[k];
    }
}

void Points::spread_multipliers(int c, const RowBuffer& lambda, RowBuffer& nu) const {
    const int n = static_cast<int>(S_.used.size()), count = S_.class_count(c);
    const double* h = length.row(0);
    for (int r = 0; r < S_.nx; ++r) {
        double* out = nu.row(r);
        std::fill_n(out, count, 0.0);
        for (int i = 0; i < S_.s - 1; ++i) {
            const double* l = lambda.row(i * S_.nx + r);
            if (const double a = S_.A[at(i * n + c)]; a != 0.0)
                for (int k = 0; k < count; ++k) out[k] += a * h[k] * l[k];
            if (!S_.shared || c != 0) continue;
            if (const double a = S_.A[at(i * n + n - 1)]; a != 0.0)
                for (int k = 0; k < count; ++k) out[k] += a * h[k - 1] * l[k - 1];
        }
    }
}

void Points::add_JF_transposed(int c, const RowBuffer& nu, RowBuffer& out) const {
    for (std::size_t k = 0; k < S_.JF.size(); ++k)
        add_product(out.row(S_.JF.column[k]), rows[at(c)].row(S_.row_JF() + static_cast<int>(k)),
                    nu.row(S_.JF.row[k]), S_.class_count(c));
}

void Points::add_Jg_transposed(int c, const RowBuffer& t, RowBuffer& out) const {
    for (std::size_t k = 0; k < S_.Jg.size(); ++k)
        add_product(out.row(S_.Jg.column[k]), rows[at(c)].row(S_.row_Jg() + static_cast<int>(k)),
                    t.row(S_.Jg.row[k]), S_.class_count(c));
}

void Points::add_H(int c, const RowBuffer& y, RowBuffer& out) const {
    for (std::size_t k = 0; k < S_.H.size(); ++k) {
        const double* h = rows[at(c)].row(S_.row_H() + static_cast<int>(k));
        const int i = S_.H.row[k], j = S_.H.column[k], count = S_.class_count(c);
        add_product(out.row(i), h, y.row(j), count);
        if (i != j) add_product(out.row(j), h, y.row(i), count);
    }
}

void Points::add_cost_gradient(int c, RowBuffer& out) const {
    for (std::size_t k = 0; k < S_.gradient.size(); ++k)
        add_product(out.row(S_.gradient[k]),
                    rows[at(c)].row(S_.row_gradient() + static_cast<int>(k)), cost[at(c)].row(0),
                    S_.class_count(c));
}

void Points::JF(int c, const RowBuffer& y, RowBuffer& out) const {
    for (int r = 0; r < S_.nx; ++r) std::fill_n(out.row(r), S_.class_count(c), 0.0);
    for (std::size_t k = 0; k < S_.JF.size(); ++k)
        add_product(out.row(S_.JF.row[k]), rows[at(c)].row(S_.row_JF() + static_cast<int>(k)),
                    y.row(S_.JF.column[k]), S_.class_count(c));
}

void Points::Jg(int c, const RowBuffer& y, RowBuffer& out) const {
    for (int r = 0; r < S_.ng; ++r) std::fill_n(out.row(r), S_.class_count(c), 0.0);
    for (std::size_t k = 0; k < S_.Jg.size(); ++k)
        add_product(out.row(S_.Jg.row[k]), rows[at(c)].row(S_.row_Jg() + static_cast<int>(k)),
                    y.row(S_.Jg.column[k]), S_.class_count(c));
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
