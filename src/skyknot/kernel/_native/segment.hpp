// One segment seen through a Builder: its scheme rows and its Hessian over y.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "elimination.hpp"
#include "sparse_lu.hpp"

namespace skyknot::inline SKYKNOT_ISA {

struct Segment {
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }

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
        const auto owner = static_cast<std::uint32_t>(next ? 0 : column);
        return b.block_input(source::first_class + 2 * owner, index(row), index(S.class_rows()), next);
    }
    Value path_weight(int column, int row) {
        return b.input(source::first_class + 2 * static_cast<std::uint32_t>(column) + 1, index(row));
    }
    Value v_row(std::uint32_t from, int y) {
        if (y < S.nx) return b.input(from, index(S.state_row(0, y)));
        if (y < S.s * S.nx) {
            const int point = y / S.nx, i = y % S.nx;
            return point == S.s - 1 ? b.input(from, index(S.state_row(0, i)), 1)
                                    : b.input(from, index(S.state_row(point, i)));
        }
        const int c = (y - U(0, 0)) / S.nu, i = (y - U(0, 0)) % S.nu;
        if (S.carry && y >= previous(0))
            return b.input(from, index(S.control_row(0, y - previous(0))), -1);
        return S.shared && c == S.m - 1 ? b.input(from, index(S.control_row(0, i)), 1)
                                        : b.input(from, index(S.control_row(c, i)));
    }

    // y positions and coefficients of entry `column` of a point's (x, u, q).
    std::vector<std::pair<int, double>> spread(int point_column, int column) const {
        if (column < S.nx) return {{X(S.used[index(point_column)], column), 1.0}};
        if (column >= S.nx + S.nu) return {{q(column - S.nx - S.nu), 1.0}};
        std::vector<std::pair<int, double>> positions;
        for (int c = 0; c < S.m; ++c)
            if (const double weight = S.W[index(point_column * S.m + c)]; weight != 0.0)
                positions.emplace_back(U(c, column - S.nx), weight);
        return positions;
    }

    // [M | −N]: rows of the scheme over y, scaled to coefficient 1 on X_{i+1}.
    Matrix scheme_rows() {
        std::vector<std::vector<std::vector<Term>>> terms(
            index(S.interior()), std::vector<std::vector<Term>>(index(ny())));
        const Value h = b.input(source::fixed, 0);
        const auto turned = [this](int y) { return is_interior(y) ? 1.0 : -1.0; };
        for (int i = 0; i < S.s - 1; ++i) {
            const double scale = 1.0 / S.C[index(i * S.s + i + 1)];
            for (int j = 0; j < S.s; ++j)
                for (int r = 0; r < S.nx; ++r)
                    if (const double c = scale * S.C[index(i * S.s + j)]; c != 0.0)
                        terms[index(i * S.nx + r)][index(X(j, r))].emplace_back(
                            b.constant(c * turned(X(j, r))), b.one());
            for (int column = 0; column < static_cast<int>(S.used.size()); ++column) {
                const double a = scale * S.A[index(i) * S.used.size() + index(column)];
                if (a == 0.0) continue;
                for (std::size_t k = 0; k < S.JF.size(); ++k) {
                    const Value J = class_row(column, S.row_JF() + static_cast<int>(k));
                    for (const auto& [y, weight] : spread(column, S.JF.column[k]))
                        terms[index(i * S.nx + S.JF.row[k])][index(y)].emplace_back(
                            b.product(h, b.constant(a * weight * turned(y))), J);
                }
            }
        }
        Matrix rows = zeros(S.interior(), ny());
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (std::size_t y = 0; y < rows[i].size(); ++y) rows[i][y] = b.dot(terms[i][y]);
        if (elastic)
            for (int r = 0; r < S.nx; ++r)
                rows[index((S.s - 2) * S.nx + r)][index(E(r))] = b.constant(-1.0);
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
            H[index(place.first)][index(place.second)] = H[index(place.second)][index(place.first)] =
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
        const RateRow& row = S.rates[index(r)];
        std::vector<std::pair<int, Value>> entries;
        if (S.carry) {
            entries.emplace_back(previous(row.control), b.constant(row.weights[0]));
            entries.emplace_back(U(0, row.control), b.constant(row.weights[1]));
        } else {
            for (int c = 0; c < S.m; ++c)
                if (row.weights[index(c)] != 0.0)
                    entries.emplace_back(U(c, row.control), b.constant(row.weights[index(c)]));
        }
        if (S.free_duration) entries.emplace_back(q(0), b.input(source::fixed, index(1 + r)));
        const Value D = b.input(source::weight_r, index(r));
        for (std::size_t k = 0; k < entries.size(); ++k)
            for (std::size_t l = 0; l <= k; ++l)
                add(entries[k].first, entries[l].first, b.product(D, entries[k].second),
                    entries[l].second);
    }
};

}  // namespace skyknot::inline SKYKNOT_ISA
