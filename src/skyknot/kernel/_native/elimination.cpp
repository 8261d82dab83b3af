#include "elimination.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace skyknot::inline SKYKNOT_ISA {
namespace {

using Matrix = std::vector<std::vector<Value>>;

Matrix zeros(int rows, int columns) {
    return Matrix(static_cast<std::size_t>(rows),
                  std::vector<Value>(static_cast<std::size_t>(columns)));
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Sparse LU with diagonal pivots in Markowitz order. Entries wait as sums until they are read.
struct Factors {
    std::vector<int> order;
    Matrix LU;                    // L below (unit diagonal), U above, in pivot order
    std::vector<Value> inverse;   // 1 / pivot
};

Factors factorise(Builder& b, Matrix M) {
    const int n = static_cast<int>(M.size());
    std::vector<std::vector<std::vector<Term>>> waiting(
        at(n), std::vector<std::vector<Term>>(at(n)));
    std::vector<char> done(at(n), 0);
    const auto nonzero = [&](int i, int j) {
        return !M[at(i)][at(j)].is_zero() || !waiting[at(i)][at(j)].empty();
    };
    const auto settle = [&](int i, int j) {
        auto& terms = waiting[at(i)][at(j)];
        if (!terms.empty()) M[at(i)][at(j)] = b.dot(terms, M[at(i)][at(j)], true);
        terms.clear();
    };
    Factors f{{}, {}, std::vector<Value>(at(n))};
    for (int step = 0; step < n; ++step) {
        int pivot = -1;
        long best = std::numeric_limits<long>::max();
        for (int p = 0; p < n; ++p) {
            if (done[at(p)]) continue;
            long in_row = 0, in_column = 0;
            for (int j = 0; j < n; ++j) {
                if (done[at(j)] || j == p) continue;
                in_row += nonzero(p, j);
                in_column += nonzero(j, p);
            }
            if (in_row * in_column < best) best = in_row * in_column, pivot = p;
        }
        done[at(pivot)] = 1;
        f.order.push_back(pivot);
        settle(pivot, pivot);
        f.inverse[at(pivot)] = b.reciprocal(M[at(pivot)][at(pivot)]);
        for (int j = 0; j < n; ++j)
            if (!done[at(j)]) settle(pivot, j);
        for (int i = 0; i < n; ++i) {
            if (done[at(i)] || !nonzero(i, pivot)) continue;
            settle(i, pivot);
            const Value L = b.product(M[at(i)][at(pivot)], f.inverse[at(pivot)]);
            M[at(i)][at(pivot)] = L;
            for (int j = 0; j < n; ++j)
                if (!done[at(j)] && !M[at(pivot)][at(j)].is_zero())
                    waiting[at(i)][at(j)].emplace_back(L, M[at(pivot)][at(j)]);
        }
    }
    f.LU = std::move(M);
    return f;
}

// Solves M x = right.
std::vector<Value> solve(Builder& b, const Factors& f, std::vector<Value> x) {
    const std::size_t n = f.order.size();
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t p = at(f.order[k]);
        std::vector<Term> terms;
        for (std::size_t l = 0; l < k; ++l)
            terms.emplace_back(f.LU[p][at(f.order[l])], x[at(f.order[l])]);
        x[p] = b.dot(terms, x[p], true);
    }
    for (std::size_t k = n; k-- > 0;) {
        const std::size_t p = at(f.order[k]);
        std::vector<Term> terms;
        for (std::size_t l = k + 1; l < n; ++l)
            terms.emplace_back(f.LU[p][at(f.order[l])], x[at(f.order[l])]);
        x[p] = b.dot(terms, x[p], true);
        x[p] = b.product(x[p], f.inverse[p]);
    }
    return x;
}

// Solves Mᵀ x = right.
std::vector<Value> solve_transposed(Builder& b, const Factors& f, std::vector<Value> x) {
    const std::size_t n = f.order.size();
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t p = at(f.order[k]);
        std::vector<Term> terms;
        for (std::size_t l = 0; l < k; ++l)
            terms.emplace_back(f.LU[at(f.order[l])][p], x[at(f.order[l])]);
        x[p] = b.dot(terms, x[p], true);
        x[p] = b.product(x[p], f.inverse[p]);
    }
    for (std::size_t k = n; k-- > 0;) {
        const std::size_t p = at(f.order[k]);
        std::vector<Term> terms;
        for (std::size_t l = k + 1; l < n; ++l)
            terms.emplace_back(f.LU[at(f.order[l])][p], x[at(f.order[l])]);
        x[p] = b.dot(terms, x[p], true);
    }
    return x;
}

// One segment seen through a builder.
struct Segment {
    const Structure& S;
    bool elastic;
    Builder b;
    std::map<std::pair<int, int>, std::vector<Term>> hessian;  // over y, lower triangle

    Segment(const Structure& structure, bool with_elastic)
        : S(structure), elastic(with_elastic), b(static_cast<std::size_t>(structure.stride())) {}

    // Positions in y.
    int X(int point, int i) const { return point * S.nx + i; }
    int U(int c, int i) const { return S.s * S.nx + c * S.nu + i; }
    int previous(int i) const { return U(S.m, i); }
    int q(int i) const { return U(S.m, 0) + (S.carry ? S.nu : 0) + i; }
    int E(int i) const { return q(S.nq) + i; }
    int ny() const { return E(0) + (elastic ? S.nx : 0); }
    bool is_interior(int y) const { return y >= S.nx && y < S.s * S.nx; }

    // Offset of y in the stage vector w; −1 for interior states and globals.
    int stage(const StageLayout& at_stage, int y) const {
        if (y < S.nx) return at_stage.s(y);
        if (y >= E(0)) return at_stage.v(S.own_controls() * S.nu + y - E(0));
        if (is_interior(y) || y >= q(0)) return -1;
        if (S.carry && y >= previous(0)) return at_stage.s(S.nx + y - previous(0));
        const int c = (y - U(0, 0)) / S.nu, i = (y - U(0, 0)) % S.nu;
        return S.shared && c == 0 ? at_stage.s(S.nx + i) : at_stage.v(S.v_control(c, i));
    }

    // Evaluated point `column`: class rows, read at the next node when that owns the point.
    Value class_row(int column, int row) {
        const bool next = S.shared && column == S.classes();
        const auto index = static_cast<std::uint32_t>(next ? 0 : column);
        return b.input(source::first_class + 2 * index, at(row), next ? 1 : 0);
    }
    Value path_weight(int column, int row) {
        return b.input(source::first_class + 2 * static_cast<std::uint32_t>(column) + 1, at(row));
    }
    Value v_row(std::uint32_t from, int y) {
        if (y < S.nx) return b.input(from, at(S.state_row(0, y)));
        if (y < S.s * S.nx) {
            const int point = y / S.nx, i = y % S.nx;
            return point == S.s - 1 ? b.input(from, at(S.state_row(0, i)), 1)
                                    : b.input(from, at(S.state_row(point, i)));
        }
        const int c = (y - U(0, 0)) / S.nu, i = (y - U(0, 0)) % S.nu;
        if (S.carry && y >= previous(0))
            return b.input(from, at(S.control_row(0, y - previous(0))), -1);
        return S.shared && c == S.m - 1 ? b.input(from, at(S.control_row(0, i)), 1)
                                        : b.input(from, at(S.control_row(c, i)));
    }

    // y positions and coefficients of entry `column` of a point's (x, u, q).
    std::vector<std::pair<int, double>> spread(int point_column, int column) const {
        if (column < S.nx) return {{X(S.used[at(point_column)], column), 1.0}};
        if (column >= S.nx + S.nu) return {{q(column - S.nx - S.nu), 1.0}};
        std::vector<std::pair<int, double>> positions;
        for (int c = 0; c < S.m; ++c)
            if (const double weight = S.W[at(point_column * S.m + c)]; weight != 0.0)
                positions.emplace_back(U(c, column - S.nx), weight);
        return positions;
    }

    // [M | N]: rows of the scheme over y, scaled to coefficient 1 on X_{i+1}.
    Matrix scheme_rows() {
        std::vector<std::vector<std::vector<Term>>> terms(
            at(S.interior()), std::vector<std::vector<Term>>(at(ny())));
        const Value h = b.input(source::fixed, 0);
        for (int i = 0; i < S.s - 1; ++i) {
            const double scale = 1.0 / S.C[at(i * S.s + i + 1)];
            for (int j = 0; j < S.s; ++j)
                for (int r = 0; r < S.nx; ++r)
                    if (const double c = scale * S.C[at(i * S.s + j)]; c != 0.0)
                        terms[at(i * S.nx + r)][at(X(j, r))].emplace_back(b.constant(c), b.one());
            for (int column = 0; column < static_cast<int>(S.used.size()); ++column) {
                const double a = scale * S.A[at(i) * S.used.size() + at(column)];
                if (a == 0.0) continue;
                for (std::size_t k = 0; k < S.JF.size(); ++k) {
                    const Value J = class_row(column, S.row_JF() + static_cast<int>(k));
                    for (const auto& [y, weight] : spread(column, S.JF.column[k]))
                        terms[at(i * S.nx + S.JF.row[k])][at(y)].emplace_back(
                            b.product(h, b.constant(a * weight)), J);
                }
            }
        }
        Matrix rows = zeros(S.interior(), ny());
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (std::size_t y = 0; y < rows[i].size(); ++y) rows[i][y] = b.dot(terms[i][y]);
        if (elastic)
            for (int r = 0; r < S.nx; ++r)
                rows[at((S.s - 2) * S.nx + r)][at(E(r))] = b.one();
        return rows;
    }

    void add(int a, int c, Value first, Value second) {
        hessian[{std::max(a, c), std::min(a, c)}].emplace_back(first, second);
    }

    // H over y: own points, path rows, rate rows, bounds, regularisation.
    Matrix hessian_rows() {
        for (int column = 0; column < S.classes(); ++column) add_point(column);
        for (std::size_t r = 0; r < S.rates.size(); ++r) add_rate(static_cast<int>(r));
        const Value delta = b.scalar(scalar::regularisation);
        for (int y = 0; y < q(0); ++y) {
            const bool of_next = (y >= (S.s - 1) * S.nx && y < S.s * S.nx) ||
                                 (S.shared && y >= U(S.m - 1, 0) && y < U(S.m, 0)) ||
                                 (S.carry && y >= previous(0));
            if (of_next) continue;
            add(y, y, v_row(source::weight_v, y), b.one());
            add(y, y, delta, b.one());
        }
        if (elastic)
            for (int r = 0; r < S.nx; ++r)
                add(E(r), E(r), b.scalar(scalar::elastic_weight), b.one());
        Matrix H = zeros(ny(), ny());
        for (const auto& [place, terms] : hessian)
            H[at(place.first)][at(place.second)] = H[at(place.second)][at(place.first)] =
                b.dot(terms);
        return H;
    }

    void add_point(int column) {
        for (std::size_t k = 0; k < S.H.size(); ++k) {
            const Value value = class_row(column, S.row_H() + static_cast<int>(k));
            add_pair(column, S.H.row[k], S.H.column[k], value, b.one());
        }
        for (std::size_t k = 0; k < S.Jg.size(); ++k)
            for (std::size_t l = 0; l <= k; ++l) {
                if (S.Jg.row[k] != S.Jg.row[l]) continue;
                const Value weighted =
                    b.product(path_weight(column, S.Jg.row[k]),
                              class_row(column, S.row_Jg() + static_cast<int>(k)));
                add_pair(column, S.Jg.column[k], S.Jg.column[l], weighted,
                         class_row(column, S.row_Jg() + static_cast<int>(l)));
            }
    }

    // Entry (a, c), a and c possibly equal, of a point's symmetric matrix, spread over y.
    void add_pair(int column, int a, int c, Value first, Value second) {
        const auto left = spread(column, a), right = spread(column, c);
        for (const auto& [ya, wa] : left)
            for (const auto& [yc, wc] : right) {
                const bool mirrored = a != c && ya == yc;  // both triangles fall on one entry
                if (a == c && ya < yc) continue;           // the lower triangle is enough
                const double weight = wa * wc * (mirrored ? 2.0 : 1.0);
                const Value scaled = weight == 1.0 ? first : b.product(first, b.constant(weight));
                add(ya, yc, scaled, second);
            }
    }

    void add_rate(int r) {
        const RateRow& row = S.rates[at(r)];
        std::vector<std::pair<int, Value>> entries;
        if (S.carry) {
            entries.emplace_back(previous(row.control), b.constant(row.weights[0]));
            entries.emplace_back(U(0, row.control), b.constant(row.weights[1]));
        } else {
            for (int c = 0; c < S.m; ++c)
                if (row.weights[at(c)] != 0.0)
                    entries.emplace_back(U(c, row.control), b.constant(row.weights[at(c)]));
        }
        if (S.free_duration) entries.emplace_back(q(0), b.input(source::fixed, at(1 + r)));
        const Value D = b.input(source::weight_r, at(r));
        for (std::size_t k = 0; k < entries.size(); ++k)
            for (std::size_t l = 0; l <= k; ++l)
                add(entries[k].first, entries[l].first, b.product(D, entries[k].second),
                    entries[l].second);
    }
};

}  // namespace

// What `factor` leaves in the segment rows, written by one builder and read by another.
namespace {

struct Kept {
    std::vector<int> order;
    std::vector<std::vector<int>> LU, T, HI;  // segment row of each entry; −1 zero, −2 one
    std::vector<int> inverse;
    int rows = 0;
};

struct Keeper {
    Builder& b;
    std::size_t stride;
    int rows = 0;
    std::map<std::int32_t, int> known;

    int keep(Value value) {
        if (value.is_zero()) return -1;
        if (b.is_one(value)) return -2;
        const auto [place, fresh] = known.emplace(value.id, rows);
        if (fresh) b.output(target::segment, static_cast<std::size_t>(rows++) * stride, value);
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
    return row == -2 ? b.one() : b.input(source::segment, static_cast<std::size_t>(row));
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
    const Matrix H = segment.hessian_rows();
    Matrix HI(H.begin() + S.nx, H.begin() + S.nx + nI);

    Keeper keeper{b, static_cast<std::size_t>(S.stride()), 0, {}};
    Kept kept{factors.order, keeper.keep(factors.LU), keeper.keep(T), keeper.keep(HI), {}, 0};
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
    auto entry = [&](Value value, std::initializer_list<std::size_t> offsets) {
        if (value.is_zero()) return;
        const auto index = static_cast<std::uint32_t>(elimination.matrix_entries++);
        b.output(target::stage, std::size_t{index} * lane_count, value);
        for (std::size_t offset : offsets)
            elimination.matrix_scatter.push_back({index, static_cast<std::uint32_t>(offset)});
    };
    for (int r = 0; r < S.nx; ++r) {
        const auto& row = T[at((S.s - 2) * S.nx + r)];
        for (int y : w) {
            const int place = segment.stage(layout, y);
            if (place >= 0) entry(row[at(y)], {layout.A(r, place)});
            else entry(row[at(y)], {layout.rq(r, y - segment.q(0))});
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
            if (pa >= 0 && pc >= 0) entry(value, {layout.H(pa, pc), layout.H(pc, pa)});
            else if (pa >= 0) entry(value, {layout.gq(pa, qc)});
            else if (pc >= 0) entry(value, {layout.gq(pc, qa)});
            else entry(value, {layout.Hqq(qa, qc), layout.Hqq(qc, qa)});
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
    for (int i = 0; i < nI; ++i)
        b.output(target::reduced, at(i) * static_cast<std::size_t>(S.stride()), m[at(i)]);
    const Matrix T = recall(b, kept.T), HI = recall(b, kept.HI);
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
        for (int i = 0; i < nI; ++i) terms.emplace_back(T[at(i)][at(y)], c[at(S.nx + i)]);
        const Value value = b.dot(terms, c[at(y)]);
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
    const Matrix T = recall(b, kept.T);
    std::vector<Value> delta(at(segment.ny()));
    for (int y = 0; y < segment.ny(); ++y) {
        if (segment.is_interior(y) && y < (S.s - 1) * S.nx) continue;
        if (y >= segment.E(0)) delta[at(y)] = b.input(source::elastic, at(y - segment.E(0)));
        else if (y >= segment.q(0))
            delta[at(y)] = b.scalar(scalar::first_global + static_cast<std::uint32_t>(y - segment.q(0)));
        else delta[at(y)] = segment.v_row(source::step, y);
    }
    for (int i = 0; i < nI - S.nx; ++i) {
        std::vector<Term> terms;
        for (int y : outside(segment)) terms.emplace_back(T[at(i)][at(y)], delta[at(y)]);
        const Value x = b.dot(terms, b.input(source::reduced, at(i)));
        delta[at(S.nx + i)] = x;
        b.output(target::step, at(S.state_row(1 + i / S.nx, i % S.nx)) * stride, x);
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
    const std::vector<Value> L = solve_transposed(b, recall_factors(b, kept), std::move(right));
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
    std::sort(vector_scatter.begin(), vector_scatter.end(), by_offset);
}

}  // namespace skyknot::inline SKYKNOT_ISA
