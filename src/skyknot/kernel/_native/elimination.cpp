#include "elimination.hpp"

#include <map>
#include <utility>

#include "segment.hpp"
#include "transpose.hpp"

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

// Where the workspace's values go, by groups of eight consecutive doubles.
struct Chunks {
    std::map<std::size_t, std::array<std::uint32_t, 8>> places;

    void put(std::size_t offset, std::uint32_t place) { places[offset / 8 * 8][offset % 8] = place; }
    std::vector<Elimination::Chunk> list() const {
        std::vector<Elimination::Chunk> chunks;
        for (const auto& [offset, eight] : places)
            chunks.push_back({static_cast<std::uint32_t>(offset), eight});
        return chunks;
    }
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
    Chunks stage, hessian;
    const auto entry = [&](Chunks& chunks, Value value, std::initializer_list<std::size_t> offsets) {
        if (value.is_zero()) return;
        for (const std::size_t offset : offsets) chunks.put(offset, b.place(value));
    };
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
    elimination.matrix_chunks = stage.list();
    elimination.hessian_chunks = hessian.list();
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
    Chunks vector;
    const std::vector<int> w = outside(segment);
    for (int r = 0; r < S.nx; ++r)
        vector.put(layout.r(r), b.place(m[at((S.s - 2) * S.nx + r)]));
    for (int y : w) {
        std::vector<Term> terms;
        for (int i = 0; i < nI; ++i) terms.emplace_back(N[at(i)][at(y)], pulled[at(i)]);
        const Value value = b.dot(terms, c[at(y)], true);
        const int place = segment.stage(layout, y);
        if (place >= 0) vector.put(layout.g(place), b.place(value));
        else elimination.global_places.push_back(b.place(value));
    }
    elimination.vector_chunks = vector.list();
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
}

void Elimination::write(const std::vector<Chunk>& chunks, const double* workspace, double* to,
                        std::size_t size, int filled) {
    for (const auto& [offset, places] : chunks) {
        Vector8Block block;
        for (std::size_t i = 0; i < 8; ++i)
            block.rows[i] = load_wide(workspace + std::size_t{places[i]} * lane_count);
        block.transpose();
        for (std::size_t lane = 0; lane < static_cast<std::size_t>(filled); ++lane)
            store_wide(to + lane * size + offset, block.rows[lane]);
    }
}

}  // namespace skyknot::inline SKYKNOT_ISA
