#include "sparse_lu.hpp"

#include <limits>
#include <utility>

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

Matrix zeros(int rows, int columns) {
    return Matrix(static_cast<std::size_t>(rows),
                  std::vector<Value>(static_cast<std::size_t>(columns)));
}

// Entries wait as sums until they are read, so that each is one instruction.
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

}  // namespace skyknot::inline SKYKNOT_ISA
