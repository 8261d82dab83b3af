#include "elimination.hpp"

#include <algorithm>
#include <map>
#include <utility>

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

    explicit Keeper(Builder& builder) : b(builder) {
        b.output(target::segment, 0, b.one());  // row 0: see Builder::stored
        ++rows;
    }

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

// What stands where in the stage vector w = (v, s): its y, or −1 where there is padding.
std::vector<int> stage_order(const Segment& segment, const StageLayout& layout) {
    std::vector<int> order(at(layout.wp), -1);
    for (const int y : outside(segment))
        if (const int place = segment.stage(layout, y); place >= 0) order[at(place)] = y;
    return order;
}

// Eight entries from `first` of a list, zeros past its end.
template <class Entry>
Eight eight_from(int first, int count, Entry entry) {
    Eight values{};
    for (int j = 0; j < 8 && first + j < count; ++j) values[at(j)] = entry(first + j);
    return values;
}

// Eight places of the stage vector from `first`: entry(y), zeros where there is padding.
template <class Entry>
Eight eight_of_stage(const std::vector<int>& order, int first, Entry entry) {
    return eight_from(first, static_cast<int>(order.size()), [&](int w) {
        return order[at(w)] < 0 ? Value{} : entry(order[at(w)]);
    });
}

// The map to x_{k+1}, the last rows of T, with its columns of the globals.
void write_map(Segment& segment, const StageLayout& layout, const Matrix& T) {
    const Structure& S = segment.S;
    const std::vector<int> order = stage_order(segment, layout);
    const auto last = [&](int r, int y) { return T[at((S.s - 2) * S.nx + r)][at(y)]; };
    for (int r = 0; r < S.nx; ++r)
        for (int first = 0; first < layout.wp; first += 8)
            segment.b.block(block::stage, layout.A(r, first),
                            eight_of_stage(order, first, [&](int y) { return last(r, y); }));
    for (int q = 0; q < S.nq; ++q)
        for (int first = 0; first < S.nx; first += 8)
            segment.b.block(block::stage, layout.rq(first, q), eight_from(first, S.nx, [&](int r) {
                return last(r, segment.q(q));
            }));
}

// The Hessian over w and q, H_ww + H_wI T + Tᵀ Ĝ with Ĝ = H_II T + H_Iw: column by column, eight
// rows at a time, on and below the diagonal's blocks of eight.
void write_hessian(Segment& segment, const StageLayout& layout, const Matrix& H, const Matrix& T) {
    const Structure& S = segment.S;
    Builder& b = segment.b;
    const int nI = S.interior();
    const std::vector<int> order = stage_order(segment, layout);
    std::vector<std::vector<Row8>> rows(at(nI));  // T, eight columns of w at a time
    const auto inside = [&](int y, int c, Value start) {  // start + H_yI T over column c
        std::vector<Term> terms;
        for (int i = 0; i < nI; ++i) terms.emplace_back(H[at(y)][at(S.nx + i)], T[at(i)][at(c)]);
        return b.dot(terms, start);
    };
    for (int i = 0; i < nI; ++i) {
        const auto& H_row = H[at(S.nx + i)];
        if (std::all_of(H_row.begin(), H_row.end(), [](Value v) { return v.is_zero(); })) continue;
        for (int first = 0; first < layout.wp; first += 8)
            rows[at(i)].push_back(
                b.row8(eight_of_stage(order, first, [&](int y) { return T[at(i)][at(y)]; })));
    }
    const auto column = [&](int c, int from, std::uint32_t target, auto offset) {
        std::vector<Value> G(at(nI));
        for (int i = 0; i < nI; ++i)
            if (!rows[at(i)].empty()) G[at(i)] = inside(S.nx + i, c, H[at(S.nx + i)][at(c)]);
        for (int first = from; first < layout.wp; first += 8) {
            std::vector<std::pair<Value, Row8>> terms;
            for (int i = 0; i < nI; ++i)
                if (!G[at(i)].is_zero()) terms.emplace_back(G[at(i)], rows[at(i)][at(first / 8)]);
            const Eight start = eight_of_stage(
                order, first, [&](int y) { return inside(y, c, H[at(y)][at(c)]); });
            b.panel(target, offset(first), start, terms);
        }
        return G;
    };
    for (int w = 0; w < layout.wp; ++w) {
        if (w % 4 == 0) b.next_phase();
        if (order[at(w)] >= 0)
            column(order[at(w)], w / 8 * 8, block::hessian, [&](int first) { return layout.H(first, w); });
    }
    std::vector<Value> between(at(S.nq * S.nq));
    for (int q = 0; q < S.nq; ++q) {
        const int c = segment.q(q);
        const std::vector<Value> G =
            column(c, 0, block::stage, [&](int first) { return layout.gq(first, q); });
        for (int p = 0; p < S.nq; ++p) {
            std::vector<Term> terms;
            for (int i = 0; i < nI; ++i) terms.emplace_back(T[at(i)][at(segment.q(p))], G[at(i)]);
            between[at(p * S.nq + q)] =
                b.dot(terms, inside(segment.q(p), c, H[at(segment.q(p))][at(c)]));
        }
    }
    const int pairs = S.nq * S.nq;
    for (int first = 0; first < pairs; first += 8)
        b.block(block::stage, layout.Hqq(0, 0) + at(first),
                eight_from(first, pairs, [&](int pair) { return between[at(pair)]; }));
}

Kept build_factor(Elimination& elimination, Segment& segment, const StageLayout& layout) {
    const Structure& S = segment.S;
    Builder& b = segment.b;
    const Matrix rows = segment.scheme_rows();  // [M | −N]
    const int nI = S.interior();
    Matrix M = zeros(nI, nI);
    for (int i = 0; i < nI; ++i)
        for (int j = 0; j < nI; ++j) M[at(i)][at(j)] = rows[at(i)][at(S.nx + j)];
    const Factors factors = factorise(b, std::move(M));
    const std::vector<int> w = outside(segment);
    Matrix N = zeros(nI, segment.ny()), T = N;  // N with its sign turned
    for (int i = 0; i < nI; ++i)
        for (int y : w) N[at(i)][at(y)] = rows[at(i)][at(y)];
    for (int y : w) {
        std::vector<Value> column(at(nI));
        for (int i = 0; i < nI; ++i) column[at(i)] = N[at(i)][at(y)];
        column = solve(b, factors, std::move(column));
        for (int i = 0; i < nI; ++i) T[at(i)][at(y)] = column[at(i)];
    }
    const Matrix H = segment.hessian_rows();
    Matrix HI(H.begin() + S.nx, H.begin() + S.nx + nI);

    Keeper keeper(b);
    Kept kept{factors.order, keeper.keep(factors.LU), keeper.keep(N), keeper.keep(HI), {}, 0};
    for (Value value : factors.inverse) kept.inverse.push_back(keeper.keep(value));
    kept.rows = keeper.rows;

    write_map(segment, layout, T);
    write_hessian(segment, layout, H, T);
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
    // Tᵀ c_I = −Nᵀ M⁻ᵀ c_I: the factors and the sparse N, kept as −N, are smaller than T.
    const std::vector<Value> pulled =
        solve_transposed(b, factors, {c.begin() + S.nx, c.begin() + S.nx + nI});
    const auto reduced = [&](int y) {
        std::vector<Term> terms;
        for (int i = 0; i < nI; ++i) terms.emplace_back(N[at(i)][at(y)], pulled[at(i)]);
        return b.dot(terms, c[at(y)]);
    };
    for (int first = 0; first < S.nx; first += 8)
        b.block(block::vector, layout.r(first), eight_from(first, S.nx, [&](int r) {
            return m[at((S.s - 2) * S.nx + r)];
        }));
    const std::vector<int> order = stage_order(segment, layout);
    for (int first = 0; first < layout.wp; first += 8)
        b.block(block::vector, layout.g(first), eight_of_stage(order, first, reduced));
    for (int q = 0; q < S.nq; ++q)
        elimination.global_places.push_back(b.place(reduced(segment.q(q))));
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
        states[at(i)] = b.dot(terms, states[at(i)]);
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
}

}  // namespace skyknot::inline SKYKNOT_ISA
