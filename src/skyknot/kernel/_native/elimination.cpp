#include "elimination.hpp"

#include <algorithm>
#include <map>

#include "segment.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// What `factor` leaves in the segment rows, written by one builder and read by another.
struct Kept {
    std::vector<int> order;
    std::vector<std::vector<int>> LU, N, HI;  // segment row of each entry; −1 zero, −2 one
    std::vector<int> inverse;
    int rows = 0;
};

struct Keeper {
    Builder& b;
    int rows = 0;
    std::map<std::int32_t, int> known;

    int keep(Value value) {
        if (value.is_zero()) return -1;
        if (b.is_one(value)) return -2;
        const auto [place, fresh] = known.emplace(value.id, rows);
        if (fresh) b.output(target::segment, static_cast<std::size_t>(rows++) * lane_count, value);
        return place->second;
    }
    std::vector<std::vector<int>> keep(const Matrix& values) {
        std::vector<std::vector<int>> places;
        for (const auto& row : values) {
            places.emplace_back();
            for (Value value : row) places.back().push_back(keep(value));
        }
        return places;
    }
};

Value recall(Builder& b, int row) {
    if (row == -1) return {};
    return row == -2 ? b.one() : b.stored(source::segment, static_cast<std::size_t>(row));
}

Matrix recall(Builder& b, const std::vector<std::vector<int>>& rows) {
    Matrix values;
    for (const auto& row : rows) {
        values.emplace_back();
        for (int place : row) values.back().push_back(recall(b, place));
    }
    return values;
}

Factors recall_factors(Builder& b, const Kept& kept) {
    Factors f{kept.order, recall(b, kept.LU), {}};
    for (int row : kept.inverse) f.inverse.push_back(recall(b, row));
    return f;
}

std::vector<int> outside(const Segment& segment) {
    std::vector<int> w;
    for (int y = 0; y < segment.ny(); ++y)
        if (!segment.is_interior(y)) w.push_back(y);
    return w;
}

Kept build_factor(Elimination& elimination, Segment& segment, const StageLayout& layout) {
    const Structure& S = segment.S;
    Builder& b = segment.b;
    const Matrix rows = segment.scheme_rows();
    const int nI = S.interior();
    Matrix M = zeros(nI, nI);
    for (int i = 0; i < nI; ++i)
        for (int j = 0; j < nI; ++j) M[at(i)][at(j)] = rows[at(i)][at(S.nx + j)];
    const Factors factors = factorise(b, std::move(M));
    const std::vector<int> w = outside(segment);
    const Value minus = b.constant(-1.0);
    Matrix T = zeros(nI, segment.ny());
    for (int y : w) {
        std::vector<Value> column(at(nI));
        for (int i = 0; i < nI; ++i) column[at(i)] = b.product(minus, rows[at(i)][at(y)]);
        column = solve(b, factors, std::move(column));
        for (int i = 0; i < nI; ++i) T[at(i)][at(y)] = column[at(i)];
    }
    Matrix N = zeros(nI, segment.ny());
    for (int i = 0; i < nI; ++i)
        for (int y : w) N[at(i)][at(y)] = rows[at(i)][at(y)];
    const Matrix H = segment.hessian_rows();
    Matrix HI(H.begin() + S.nx, H.begin() + S.nx + nI);

    Keeper keeper{b, 0, {}};
    Kept kept{factors.order, keeper.keep(factors.LU), keeper.keep(N), keeper.keep(HI), {}, 0};
    for (Value value : factors.inverse) kept.inverse.push_back(keeper.keep(value));
    kept.rows = keeper.rows;

    // G = H_{y,I} T, then Hw = H_ww + G_w + G_wᵀ + Tᵀ (G_I).
    Matrix G = zeros(segment.ny(), segment.ny());
    for (int y = 0; y < segment.ny(); ++y)
        for (int c : w) {
            std::vector<Term> terms;
            for (int i = 0; i < nI; ++i) terms.emplace_back(H[at(y)][at(S.nx + i)], T[at(i)][at(c)]);
            G[at(y)][at(c)] = b.dot(terms);
        }
    const auto entry = [&](std::vector<Elimination::Scatter>& scatter, Value value,
                           std::initializer_list<std::size_t> offsets) {
        if (value.is_zero()) return;
        const auto index = static_cast<std::uint32_t>(elimination.matrix_entries++);
        b.output(target::stage, std::size_t{index} * lane_count, value);
        for (std::size_t offset : offsets)
            scatter.push_back({index, static_cast<std::uint32_t>(offset)});
    };
    auto& stage = elimination.matrix_scatter;
    auto& hessian = elimination.hessian_scatter;
    for (int r = 0; r < S.nx; ++r) {
        const auto& row = T[at((S.s - 2) * S.nx + r)];
        for (int y : w) {
            const int place = segment.stage(layout, y);
            if (place >= 0) entry(stage, row[at(y)], {layout.A(r, place)});
            else entry(stage, row[at(y)], {layout.rq(r, y - segment.q(0))});
        }
    }
    for (std::size_t k = 0; k < w.size(); ++k)
        for (std::size_t l = 0; l <= k; ++l) {
            const int a = w[k], c = w[l];
            std::vector<Term> terms{{H[at(a)][at(c)], b.one()},
                                    {G[at(a)][at(c)], b.one()},
                                    {G[at(c)][at(a)], b.one()}};
            for (int i = 0; i < nI; ++i) terms.emplace_back(T[at(i)][at(a)], G[at(S.nx + i)][at(c)]);
            const Value value = b.dot(terms);
            const int pa = segment.stage(layout, a), pc = segment.stage(layout, c);
            const int qa = a - segment.q(0), qc = c - segment.q(0);
            if (pa >= 0 && pc >= 0) entry(hessian, value, {layout.H(pa, pc), layout.H(pc, pa)});
            else if (pa >= 0) entry(stage, value, {layout.gq(pa, qc)});
            else if (pc >= 0) entry(stage, value, {layout.gq(pc, qa)});
            else entry(stage, value, {layout.Hqq(qa, qc), layout.Hqq(qc, qa)});
        }
    elimination.factor = b.finish();
    return kept;
}

// d scaled like the scheme's rows.
std::vector<Value> scaled_defects(Segment& segment, double sign) {
    const Structure& S = segment.S;
    std::vector<Value> d;
    for (int i = 0; i < S.s - 1; ++i)
        for (int r = 0; r < S.nx; ++r)
            d.push_back(segment.b.product(
                segment.b.constant(sign / S.C[at(i * S.s + i + 1)]),
                segment.b.input(source::defect, at(i * S.nx + r))));
    return d;
}

void build_reduce(Elimination& elimination, const Structure& S, const Kept& kept, bool elastic,
                  const StageLayout& layout) {
    Segment segment(S, elastic);
    Builder& b = segment.b;
    const int nI = S.interior();
    const Factors factors = recall_factors(b, kept);
    const std::vector<Value> m = solve(b, factors, scaled_defects(segment, -1.0));
    const Matrix N = recall(b, kept.N), HI = recall(b, kept.HI);
    const auto gradient = [&](int y) -> Value {  // of what this stage owns
        const bool of_next = (y >= (S.s - 1) * S.nx && y < S.s * S.nx) ||
                             (S.shared && y >= segment.U(S.m - 1, 0) && y < segment.U(S.m, 0)) ||
                             y >= segment.U(S.m, 0);
        return of_next ? Value{} : segment.v_row(source::gradient, y);
    };
    std::vector<Value> c(at(segment.ny()));
    for (int y = 0; y < segment.ny(); ++y) {
        std::vector<Term> terms;
        for (int i = 0; i < nI; ++i) terms.emplace_back(HI[at(i)][at(y)], m[at(i)]);
        c[at(y)] = b.dot(terms, gradient(y));
    }
    // Tᵀ c_I = −Nᵀ M⁻ᵀ c_I: the factors and the sparse N are smaller than T.
    const std::vector<Value> pulled =
        solve_transposed(b, factors, {c.begin() + S.nx, c.begin() + S.nx + nI});
    auto entry = [&](Value value) {
        const auto index = static_cast<std::uint32_t>(elimination.vector_entries++);
        b.output(target::stage, std::size_t{index} * lane_count,
                 value.is_zero() ? b.dot({{b.scalar(scalar::regularisation), b.constant(1e-300)}})
                                 : value);
        return index;
    };
    for (int r = 0; r < S.nx; ++r)
        elimination.vector_scatter.push_back(
            {entry(m[at((S.s - 2) * S.nx + r)]), static_cast<std::uint32_t>(layout.r(r))});
    for (int y : outside(segment)) {
        std::vector<Term> terms;
        for (int i = 0; i < nI; ++i) terms.emplace_back(N[at(i)][at(y)], pulled[at(i)]);
        const Value value = b.dot(terms, c[at(y)], true);
        const int place = segment.stage(layout, y);
        if (place >= 0) {
            if (!value.is_zero())
                elimination.vector_scatter.push_back(
                    {entry(value), static_cast<std::uint32_t>(layout.g(place))});
        } else {
            elimination.global_entries.push_back(entry(value));
        }
    }
    elimination.reduce = b.finish();
}

void build_expand(Elimination& elimination, const Structure& S, const Kept& kept, bool elastic) {
    Segment segment(S, elastic);
    Builder& b = segment.b;
    const int nI = S.interior();
    const auto stride = static_cast<std::size_t>(S.stride());
    const Matrix N = recall(b, kept.N);
    const Factors factors = recall_factors(b, kept);
    std::vector<Value> delta(at(segment.ny()));
    for (int y = 0; y < segment.ny(); ++y) {
        if (segment.is_interior(y) && y < (S.s - 1) * S.nx) continue;
        if (y >= segment.E(0)) delta[at(y)] = b.input(source::elastic, at(y - segment.E(0)));
        else if (y >= segment.q(0))
            delta[at(y)] = b.scalar(scalar::first_global + static_cast<std::uint32_t>(y - segment.q(0)));
        else delta[at(y)] = segment.v_row(source::step, y);
    }
    std::vector<Value> states = scaled_defects(segment, -1.0);  // M X_I = −d − N w
    for (int i = 0; i < nI; ++i) {
        std::vector<Term> terms;
        for (int y : outside(segment)) terms.emplace_back(N[at(i)][at(y)], delta[at(y)]);
        states[at(i)] = b.dot(terms, states[at(i)], true);
    }
    states = solve(b, factors, std::move(states));
    for (int i = 0; i < nI - S.nx; ++i) {
        delta[at(S.nx + i)] = states[at(i)];
        b.output(target::step, at(S.state_row(1 + i / S.nx, i % S.nx)) * stride, states[at(i)]);
    }
    const Matrix HI = recall(b, kept.HI);
    std::vector<Value> right(at(nI));
    for (int i = 0; i < nI; ++i) {
        const bool last = i >= nI - S.nx;
        std::vector<Term> terms;
        for (int y = 0; y < segment.ny(); ++y) terms.emplace_back(HI[at(i)][at(y)], delta[at(y)]);
        const Value start = last ? b.input(source::costate, at(i - (nI - S.nx)))
                                 : segment.v_row(source::gradient, S.nx + i);
        right[at(i)] = b.dot(terms, start);
    }
    const std::vector<Value> L = solve_transposed(b, factors, std::move(right));
    for (int i = 0; i < S.s - 1; ++i)
        for (int r = 0; r < S.nx; ++r) {
            const Value lambda = b.product(b.constant(-1.0 / S.C[at(i * S.s + i + 1)]),
                                           L[at(i * S.nx + r)]);
            b.output(target::defect, at(i * S.nx + r) * stride, lambda);
        }
    elimination.expand = b.finish();
}

}  // namespace

Elimination::Elimination(const Structure& S, bool elastic) {
    const StageLayout layout(S, elastic);
    Segment segment(S, elastic);
    const Kept kept = build_factor(*this, segment, layout);
    segment_rows = static_cast<std::size_t>(kept.rows);
    build_reduce(*this, S, kept, elastic, layout);
    build_expand(*this, S, kept, elastic);
    // In memory order, so that writing a stage goes forward.
    const auto by_offset = [](const Scatter& a, const Scatter& c) { return a.offset < c.offset; };
    std::sort(matrix_scatter.begin(), matrix_scatter.end(), by_offset);
    std::sort(hessian_scatter.begin(), hessian_scatter.end(), by_offset);
    std::sort(vector_scatter.begin(), vector_scatter.end(), by_offset);
}

}  // namespace skyknot::inline SKYKNOT_ISA
