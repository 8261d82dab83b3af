// Sparse LU recorded through a Builder: the arithmetic the sparsity pattern leaves, nothing else.
#pragma once

#include <vector>

#include "micro_program.hpp"

namespace skyknot::inline SKYKNOT_ISA {

using Matrix = std::vector<std::vector<Value>>;

Matrix zeros(int rows, int columns);

// Diagonal pivots in Markowitz order; L below (unit diagonal), U above.
struct Factors {
    std::vector<int> order;
    Matrix LU;
    std::vector<Value> inverse;  // 1 / pivot
};

Factors factorise(Builder& builder, Matrix M);
// M x = right and Mᵀ x = right.
std::vector<Value> solve(Builder& builder, const Factors& factors, std::vector<Value> right);
std::vector<Value> solve_transposed(Builder& builder, const Factors& factors,
                                    std::vector<Value> right);

}  // namespace skyknot::inline SKYKNOT_ISA
