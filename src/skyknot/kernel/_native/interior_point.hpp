// Primal–dual interior point with a filter line search on the structured Newton system.
//
// A. Wächter, L. T. Biegler, "On the implementation of an interior-point filter line-search
// algorithm for large-scale nonlinear programming", Math. Program. 106 (2006); equation and section
// numbers in the source refer to it. Everything inside is scaled; what is reported is not.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "box.hpp"
#include "filter.hpp"
#include "newton.hpp"
#include "points.hpp"

namespace skyknot::inline SKYKNOT_ISA {

struct Settings {
    double tolerance = 1e-6;
    double acceptable_factor = 100.0;
    double barrier_start = 0.1;
    double push = 1e-2;  // κ₁ = κ₂ of the starting point
    int max_iterations = 1000;
    double max_seconds = 600.0;
    int refinements = 3;
    bool warm = false;  // multipliers given
};

// What a restoration ends with.
enum class Restored { yes, infeasible, failed };

enum class Outcome {
    solved,
    acceptable,
    infeasible,
    iterations,
    seconds,
    evaluation,
    stalled,
    interrupted,
    unbounded
};

struct Record {
    double objective, primal, dual, barrier, step, regularisation;
};

// Everything of one group of path rows that the iteration moves.
struct GroupState {
    RowBuffer value, slack, slack_step, y, y_step, lower, upper, zl, zu, dzl, dzu;
    RowBuffer equality;  // 1 at equalities
    RowBuffer active;    // 1 where there is any bound
    RowBuffer r_slack, t, trial_value, trial_slack;
    std::vector<double> unscale;  // unscaled row = scaled row × this
    int count;

    GroupState(const Structure& structure, int rows, int columns);
};

class InteriorPoint {
public:
    InteriorPoint(const Structure& structure, const Tape& value, const Tape& full,
                  const Tape& terminal);

    // Filled by the caller: bounds, start, scales.
    RowBuffer z, lower, upper, scale;             // V rows
    std::vector<double> q, q_lower, q_upper, q_scale;
    std::vector<double> defect_scale;             // (nx,) unscaled = scaled × this
    std::vector<GroupState> groups;
    RowBuffer lambda, zl, zu;
    std::vector<double> q_zl, q_zu;
    double objective_scale = 1.0;
    std::vector<Pin> pins;
    std::vector<double> pin_multipliers;
    Points points;

    // `watch` sees every iteration and stops the solve by returning true.
    Outcome solve(const Settings& settings, const std::function<bool(const Record&)>& watch);
    // Makes sure of a factorisation for the gains at the point where `solve` ended: the last one where
    // it is that of a step so short that the gains do not change, else a new one.
    bool factor_here() { return ended_by_short_step_ || factor(); }

    // Sets the multipliers of bounds that fix unknowns, in `zu`, from stationarity at the point where
    // `solve` last differentiated.
    void complete_fixed();

    std::vector<Record> history;
    double barrier = 0.0;
    Newton newton;
    int iterations = 0, restorations = 0;

private:
    // Barrier objective φ and infeasibility θ of a point.
    struct Merit {
        double phi, theta;
    };
    struct Errors {
        double dual, primal, complementarity;  // unscaled
        double total;                          // what is compared with the tolerance
        double size = 1.0;                     // of the multipliers, s_d of (6)
    };
    // A Box with its place in the trial point and in the Hessian's diagonal.
    struct Bounded {
        Box box;
        double* trial;
        double* weight;
        double* gradient;  // where the barrier's gradient goes
    };

    void prepare_boxes();
    bool initialise(const Settings& settings);
    void estimate_multipliers();
    bool evaluate(const RowBuffer& at, const double* at_q, bool trial);
    Merit merit(bool trial) const;
    double row_residual(std::size_t group, int row, int k, bool trial) const;
    void differentiate();
    void gradients();
    Errors errors() const;
    double multiplier_scale() const;
    bool update_barrier(const Errors& e, double floor);
    bool factor();
    void assemble(double mu);
    void solve_step();
    double slope() const;
    double longest_primal(double tau) const;
    bool line_search(double tau);
    double relative_step() const;
    bool take_tiny_step(double alpha);
    bool accept(const Merit& trial, double alpha, double descent);
    bool second_order_correction(double tau, double descent);
    void make_trial(double alpha);
    void take_trial();
    void repeat_last(RowBuffer& rows) const;
    void record(const Errors& e);
    Restored restore(double tolerance);
    bool diverging() const;
    void keep_entry();
    void return_to_entry();
    Newton& elastic_system();
    void clamp_slacks(bool trial);
    double violation(bool trial, double mu) const;
    void assemble_violation(double mu, Newton& system);
    double lower_violation(double here, double mu, double& damping, Newton& system);
    void take_restored();
    void restart(const Merit& entry);
    void add_primal_barrier(double mu, Newton& system);
    Outcome give_up(const Errors& e, double tolerance, Outcome otherwise) const;
    double seconds() const;

    Structure S_;
    Direction direction_;
    std::vector<Bounded> bounded_;
    std::size_t variables_bounded_ = 0;  // how many of them are unknowns; slacks follow
    RowBuffer dzl_, dzu_, cost_gradient_, lagrangian_, right_, defect_, trial_defect_,
        used_defect_, trial_z_, cost_step_, entry_z_;
    std::vector<double> dq_zl_, dq_zu_, q_cost_, q_lagrangian_, q_right_, q_step_right_, trial_q_, entry_q_;
    std::vector<RowBuffer> used_rows_, entry_slack_;
    std::vector<const RowBuffer*> y_;
    const RowBuffer* defect_in_use_ = nullptr;  // of the step: the defects, or corrected ones
    std::vector<char> row_bounded_;             // rows of unknowns that have a bound
    bool has_rows_ = false;                     // path or rate rows
    Filter filter_;
    Merit now_{}, trial_merit_{};
    double objective_ = 0.0, trial_objective_ = 0.0;
    double theta_start_ = 0.0, last_regularisation_ = 0.0, alpha_ = 0.0, alpha_dual_ = 0.0;
    double started_ = 0.0, max_seconds_ = 0.0;
    int refinements_ = 3, tiny_steps_ = 0;
    bool augment_ = false, ended_by_short_step_ = false;
    std::unique_ptr<Newton> elastic_;
};

}  // namespace skyknot::inline SKYKNOT_ISA
