// The Newton system of the barrier problem: assembled, factored, solved and refined.
//
//     [W + Σ + δ_w   Jᵀ] [δz]     [r ]
//     [J              0] [δλ] = − [d ]
//
// W Hessian of the Lagrangian with path rows D folded in, J defects. Equality path rows and pinned
// unknowns enter with a large weight 1/δ_c and are made exact by refinement against the unreduced
// system: their multipliers are updated as in the method of multipliers, so redundant rows do no
// harm. Globals q border the system through their own right-hand sides.
#pragma once

#include <memory>
#include <vector>

#include "elimination.hpp"
#include "points.hpp"
#include "riccati.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// A group of path rows: the rows of one class of points, or the rate rows.
struct Group {
    RowBuffer weight;    // D of inequalities, 0 elsewhere
    RowBuffer equality;  // 1/δ_c at equalities, 0 elsewhere
    RowBuffer total;     // both, what the elimination reads
    RowBuffer residual;  // g − b at equalities, 0 elsewhere
    RowBuffer linear;    // J δ, by `apply`
};

struct Direction {
    RowBuffer v, lambda;
    std::vector<double> q;
    std::vector<RowBuffer> equality;  // δy of equality rows, a group each
    std::vector<double> pins;         // multipliers of pinned unknowns
};

struct Pin {
    int row, k;
};

class Newton {
public:
    Newton(Points& points, const Tape& terminal, bool elastic);

    // Set by the caller before `factor`.
    RowBuffer weight_v;
    std::vector<double> weight_q;
    std::vector<Group> groups;  // classes, then rates
    std::vector<Pin> pins;
    double pin_weight = 0.0;
    double regularisation = 0.0;
    double elastic_weight = 0.0;
    // Tighter bought no iteration in the library's missions, and cost half of the solves again.
    double accuracy = 1e-7;

    // Terminal cost M at the last node: value, gradient over (x, q), by `evaluate_terminal`.
    double terminal_value = 0.0;
    std::vector<double> terminal_gradient;
    void evaluate_terminal(const RowBuffer& z, const double* q, double scale);

    Riccati& riccati() { return riccati_; }
    bool fixed_first(int i) const { return riccati_.fixed_first[static_cast<std::size_t>(i)] != 0; }
    const Elimination& elimination() const { return elimination_; }
    const Tape& terminal_tape() const { return terminal_; }
    Direction direction() const;

    // False when the reduced Hessian is not positive definite.
    bool factor();
    // Solves for gradient r (V rows, r_q) and defects d; refines at most `refinements` times, while
    // the residual is above `accuracy` of the right-hand side.
    // Returns the relative residual left.
    double solve(const RowBuffer& r, const double* r_q, const RowBuffer& d, Direction& out,
                 int refinements);
    // Feedback gains of the control that begins segment k in x_k, (nu, nx) row-major.
    void gains(int k, double* K) const;
    // groups[·].linear = J δ.
    void apply_rows(const RowBuffer& v, const double* q);

    long factorisations = 0, solves = 0;

private:
    void fill_terminal();
    bool factor_blocks(std::vector<const double*>& sources);
    double* segment_block(int first) {
        return segment_.get() + static_cast<std::size_t>(first) * elimination_.segment_rows - first;
    }
    bool factor_border();
    // Calls add(row, column, value) for what the point of node k adds to the Hessian over (x, u, q).
    template <class Add>
    void visit_node_hessian(int k, Add add) const;
    std::vector<double> node_control_rows(int k) const;
    void structured_solve(const RowBuffer& g, const double* g_q, const RowBuffer& d,
                          RowBuffer& step, double* step_q, RowBuffer& lambda);
    void add_equalities();
    void move_equalities(Direction& out);
    double residual(const RowBuffer& r, const double* r_q, const RowBuffer& d, Direction& at);
    void right_side(const RowBuffer& g, const RowBuffer& d, Riccati::RightSide& right,
                    double* g_q);
    void read_step(const Riccati::RightSide& right, RowBuffer& step);
    double border_product(const Riccati::RightSide& right, int q) const;
    void clear_padding(RowBuffer& rows) const;

    Points& points_;
    Structure S_;
    const Tape& terminal_;
    bool elastic_, weighted_ = false;  // some path or rate row is an equality
    Elimination elimination_;
    Riccati riccati_;
    Riccati::RightSide main_;
    std::vector<Riccati::RightSide> border_;
    std::vector<double> schur_, terminal_q_;  // (nq, nq) Cholesky; (sp, nq) terminal g_q
    Workspace segment_;  // eight segments at a time, rows one after the other
    RowBuffer costate_, elastic_step_;
    RowBuffer gradient_, defect_, step_, lambda_;
    Direction kept_;  // before the last refinement
    std::vector<double> gradient_q_, step_q_, residual_q_, step_scalars_;
    std::vector<const double*> factor_sources_;
    std::vector<BlockRows> F_;
    std::vector<RowBuffer> t_;
    Workspace terminal_workspace_, factor_workspace_, reduce_workspace_, expand_workspace_;
    std::vector<double> terminal_hessian_;
};

template <class Add>
void Newton::visit_node_hessian(int k, Add add) const {
    const auto entry = [&](int row, std::size_t e) {
        return points_.rows[0](row + static_cast<int>(e), k);
    };
    for (std::size_t e = 0; e < S_.H.size(); ++e) {
        const double h = entry(S_.row_H(), e);
        add(S_.H.row[e], S_.H.column[e], h);
        if (S_.H.row[e] != S_.H.column[e]) add(S_.H.column[e], S_.H.row[e], h);
    }
    for (std::size_t e = 0; e < S_.Jg.size(); ++e)
        for (std::size_t f = 0; f < S_.Jg.size(); ++f)
            if (S_.Jg.row[e] == S_.Jg.row[f])
                add(S_.Jg.column[e], S_.Jg.column[f],
                    groups[0].total.row(S_.Jg.row[e])[k] * entry(S_.row_Jg(), e) *
                        entry(S_.row_Jg(), f));
}

}  // namespace skyknot::inline SKYKNOT_ISA
