// The evaluated points: tapes run over lanes, and sparse products with what they return.
//
// Legend: c cost weights (objective scale included), ν = Σ δ A λ multipliers of F at a point,
// y multipliers of g. A point's variables are (x, u, q).
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "row_buffer.hpp"
#include "structure.hpp"
#include "tape.hpp"

namespace skyknot::inline SKYKNOT_ISA {

class Points {
public:
    // value: (x, u, q, τ, p) → (L, F, g); full: (x, u, q, τ, p, c, ν, y) → class rows.
    Points(const Structure& structure, const Tape& value, const Tape& full);

    std::vector<RowBuffer> rows;       // class rows, one buffer a class
    std::vector<RowBuffer> time;       // τ, one row a class
    std::vector<RowBuffer> cost;       // c, one row a class
    RowBuffer length;                  // row 0: δ; then each rate row's coefficient of the duration
    std::vector<double> parameters;    // p, the same at every point

    // L, F and g at z.
    void evaluate(const RowBuffer& z, const double* q);
    // Everything at z with multipliers λ (D rows) and y (one buffer of ng rows a class).
    void differentiate(const RowBuffer& z, const double* q, const RowBuffer& lambda,
                       const std::vector<const RowBuffer*>& y);
    // Σ c L over all points.
    double cost_sum() const;
    // D rows: predicted minus actual.
    void defects(const RowBuffer& z, RowBuffer& d) const;
    // Rate rows at v: (rates, N); and their transpose.
    void rates(const RowBuffer& v, const double* q, RowBuffer& out) const;
    void add_rates_transposed(const RowBuffer& t, RowBuffer& v, double* globals) const;

    // (x, u, q) rows of a class at z or at a step.
    void gather(int c, const RowBuffer& v, const double* q, RowBuffer& out) const;
    // Adds (x, u) rows of a class to V rows and sums q rows into `globals`.
    void scatter(int c, const RowBuffer& in, RowBuffer& v, double* globals) const;
    // ν rows of a class.
    void spread_multipliers(int c, const RowBuffer& lambda, RowBuffer& nu) const;
    // out += ∂Fᵀ ν, ∂gᵀ t, H y, and the gradient of c L.
    void add_JF_transposed(int c, const RowBuffer& nu, RowBuffer& out) const;
    void add_Jg_transposed(int c, const RowBuffer& t, RowBuffer& out) const;
    void add_H(int c, const RowBuffer& y, RowBuffer& out) const;
    void add_cost_gradient(int c, RowBuffer& out) const;
    // ∂F y (nx rows) and ∂g y (ng rows), overwriting.
    void JF(int c, const RowBuffer& y, RowBuffer& out) const;
    void Jg(int c, const RowBuffer& y, RowBuffer& out) const;
    // Adds Σ_i C_ij λ_i to the V rows of the states.
    void add_C_transposed(const RowBuffer& lambda, RowBuffer& v) const;
    // d = Σ C x + δ Σ A F over D rows, F given as nx rows a class.
    void combine(const RowBuffer& v, const std::vector<RowBuffer>& F, int first_row,
                 RowBuffer& d) const;

    const Structure& structure() const { return S_; }
    long value_runs = 0, full_runs = 0;

private:
    void run(const Tape& tape, double* workspace, int c, const RowBuffer& z, const double* q,
             const RowBuffer* nu, const RowBuffer* y);
    const double* state(int c, const RowBuffer& v, int i) const;
    std::pair<int, int> rate_place(const RateRow& row, int m) const;

    Structure S_;
    const Tape& value_;
    const Tape& full_;
    Workspace value_workspace_, full_workspace_;
    RowBuffer nu_;
};

}  // namespace skyknot::inline SKYKNOT_ISA
