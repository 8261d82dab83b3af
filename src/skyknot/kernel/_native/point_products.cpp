#include "point_products.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

using Sums = std::vector<std::vector<Term>>;

}  // namespace

PointProducts::PointProducts(const Structure& S, Of what) {
    Builder b(lane_count);
    const bool hessian = what == Of::step, rates = what == Of::step || what == Of::adjoint;
    const bool forward = what == Of::step || what == Of::path_step;
    const bool backward = what != Of::path_step;
    const auto reserve = [&](int rows, std::uint32_t& place) {
        std::vector<Value> values;
        for (int i = 0; i < rows; ++i) values.push_back(b.reserve());
        if (rows > 0) place = b.place(values.front());
        return values;
    };
    const std::vector<Value> y = reserve(forward ? S.ny() : 0, y_), nu = reserve(rates ? S.nx : 0, nu_);
    const std::vector<Value> given = reserve(backward ? S.ng : 0, t_);
    const std::vector<Value> D = reserve(hessian ? S.ng : 0, weight_);
    const auto entry = [&](int row, std::size_t k) { return b.stored(0, at(row) + k); };
    const auto add = [](Sums& sums, int i, Value a, Value c) { sums[at(i)].emplace_back(a, c); };

    Sums out(at(S.ny())), F(at(S.nx)), path(at(S.ng));
    for (std::size_t k = 0; hessian && k < S.H.size(); ++k) {
        const int i = S.H.row[k], j = S.H.column[k];
        add(out, i, entry(S.row_H(), k), y[at(j)]);
        if (i != j) add(out, j, entry(S.row_H(), k), y[at(i)]);
    }
    for (std::size_t k = 0; rates && k < S.JF.size(); ++k) {
        const int i = S.JF.row[k], j = S.JF.column[k];
        add(out, j, entry(S.row_JF(), k), nu[at(i)]);
        if (hessian) add(F, i, entry(S.row_JF(), k), y[at(j)]);
    }
    for (std::size_t k = 0; forward && k < S.Jg.size(); ++k)
        add(path, S.Jg.row[k], entry(S.row_Jg(), k), y[at(S.Jg.column[k])]);
    std::vector<Value> t = given;
    for (int i = 0; i < S.ng; ++i) {
        const Value along = b.dot(path[at(i)]);
        if (forward) path_.push_back(b.place(along));
        if (hessian) t[at(i)] = b.dot({{D[at(i)], along}}, given[at(i)]);
    }
    for (std::size_t k = 0; backward && k < S.Jg.size(); ++k)
        add(out, S.Jg.column[k], entry(S.row_Jg(), k), t[at(S.Jg.row[k])]);
    if (backward)
        for (const std::vector<Term>& terms : out) out_.push_back(b.place(b.dot(terms)));
    if (hessian)
        for (const std::vector<Term>& terms : F) rates_.push_back(b.place(b.dot(terms)));
    program_ = b.finish();
    workspace_ = make_workspace(lane_count * program_.slots());
}

}  // namespace skyknot::inline SKYKNOT_ISA
