// The evaluated points: tapes run over lanes, and sparse products with what they return.
//
// Legend: c cost weights (objective scale included), ν = Σ δ A λ multipliers of F at a point,
// y multipliers of g. A point's variables are (x, u, q).
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "block_rows.hpp"
#include "point_products.hpp"
#include "row_buffer.hpp"
#include "structure.hpp"
#include "tape.hpp"

namespace skyknot::inline SKYKNOT_ISA {

class Points {
public:
    // value: (x, u, q, τ, p) → (L, F, g); full: (x, u, q, τ, p, c, ν, y) → class rows.
    Points(const Structure& structure, const Tape& value, const Tape& full);

    std::vector<BlockRows> rows;       // class rows, one buffer a class
    std::vector<RowBuffer> time;       // τ, one row a class
    std::vector<RowBuffer> cost;       // c, one row a class
    RowBuffer length;                  // row 0: δ; then each rate row's coefficient of the duration
    std::vector<double> parameters;    // p, the same at every point

    // L, F and g at z.
    void evaluate(const RowBuffer& z, const double* q);
    // Everything at z with multipliers λ (D rows) and y (one buffer of ng rows a class).
    void differentiate(const RowBuffer& z, const double* q, const RowBuffer& lambda,
                       const std::vector<const RowBuffer*>& y);
    void clear_hessian();
    // Σ c L over all points.
    double cost_sum() const;
    // D rows: predicted minus actual.
    void defects(const RowBuffer& z, RowBuffer& d) const;
    // Rate rows at v: (rates, N); and their transpose.
    void rates(const RowBuffer& v, const double* q, RowBuffer& out) const;
    void add_rates_transposed(const RowBuffer& t, RowBuffer& v, double* globals) const;

    // What follows adds to V rows and to the globals.
    //
    // Gradient of Σ c L.
    void add_cost_gradient(RowBuffer& v, double* globals);
    // Gradient of λᵀ defects + Σ yᵀ g; without `y`, of the defects alone.
    void add_adjoint(const RowBuffer& lambda, const std::vector<const RowBuffer*>& y, RowBuffer& v,
                     double* globals);
    // ∂gᵀ t of a class.
    void add_path_adjoint(int c, const RowBuffer& t, RowBuffer& v, double* globals);
    // ∂g δ of a class, overwriting `out`.
    void path_products(int c, const RowBuffer& step, const double* step_q, RowBuffer& out);

    // Path rows of a class in the Newton system: weight D, multiplier y of equalities; D ∂g δ + y
    // acts on the gradient, `linear` takes ∂g δ.
    struct PathRows {
        const RowBuffer &weight, &multiplier;
        RowBuffer& linear;
    };
    // H δ + ∂Fᵀ ν + ∂gᵀ (D ∂g δ + y) of a class; F takes ∂F δ, nx rows.
    void add_products(int c, const RowBuffer& step, const double* step_q, const RowBuffer& lambda,
                      const PathRows& path, BlockRows& F, RowBuffer& v, double* globals);
    // Adds Σ_i C_ij λ_i to the V rows of the states.
    void add_C_transposed(const RowBuffer& lambda, RowBuffer& v) const;
    // d = Σ C x + δ Σ A F over D rows, F given as nx rows a class; added to `base` where there is one.
    void combine(const RowBuffer& v, const std::vector<BlockRows>& F, int first_row,
                 const RowBuffer* base, RowBuffer& d) const;

    const Structure& structure() const { return S_; }
    long value_runs = 0, full_runs = 0;

private:
    void run(const Tape& tape, double* workspace, int c, const RowBuffer& z, const double* q,
             const RowBuffer* lambda, const RowBuffer* y);
    const double* state(int c, const RowBuffer& v, int i) const;
    std::pair<int, int> rate_place(const RateRow& row, int m) const;
    // Of eight points of a class, from `first`: their (x, u, q), and their ν; a row every `stride`.
    void gather(int c, int first, const RowBuffer& v, const double* q, double* to, int stride) const;
    void gather_multipliers(int c, int first, const RowBuffer& lambda, double* to, int stride) const;
    // Adds what eight points gave, entry i of (x, u, q) at row(i), to V rows and globals.
    template <class Row>
    void scatter(int c, int first, Row row, RowBuffer& v, double* globals) const;
    void load_rows(const RowBuffer& from, int first, double* to) const;
    template <class Block>
    void for_blocks(int c, Block block);

    Structure S_;
    const Tape& value_;
    const Tape& full_;
    Workspace value_workspace_, full_workspace_;
    Workspace gradient_;  // of the cost at eight points; zero where it has no entry
    PointProducts step_, adjoint_, path_step_, path_adjoint_;
};

}  // namespace skyknot::inline SKYKNOT_ISA
