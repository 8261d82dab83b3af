#include "newton.hpp"

#include <algorithm>
#include <cmath>

#include "reductions.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void copy_direction(const Direction& from, Direction& to) {
    to.v.copy(from.v), to.lambda.copy(from.lambda);
    to.q = from.q, to.pins = from.pins;
    for (std::size_t g = 0; g < from.equality.size(); ++g) to.equality[g].copy(from.equality[g]);
}

// Largest entry of a defect's rows.
double largest_defect(const RowBuffer& rows, const Structure& S) {
    double most = 0.0;
    for (int i = 0; i < rows.rows(); ++i) most = largest_absolute(rows.row(i), S.N, most);
    return most;
}

// Largest entry of the rows of unknowns.
double largest_gradient(const RowBuffer& rows, const Structure& S) {
    double most = 0.0;
    for (int i = 0; i < rows.rows(); ++i) most = largest_absolute(rows.row(i), S.count(i), most);
    return most;
}

}  // namespace

Newton::Newton(Points& points, const Tape& terminal, bool elastic)
    : weight_v(points.structure(), points.structure().v_rows()),
      weight_q(at(points.structure().nq)),
      terminal_gradient(at(points.structure().nx + points.structure().nq)),
      points_(points),
      S_(points.structure()),
      terminal_(terminal),
      elastic_(elastic),
      elimination_(S_, elastic),
      riccati_(S_, elastic),
      main_(riccati_.right_side()),
      schur_(at(S_.nq * S_.nq)),
      terminal_q_(at(riccati_.layout().sp * S_.nq)),
      segment_(make_workspace(elimination_.segment_rows * at(padded8(S_.N)))),
      costate_(S_, S_.nx),
      elastic_step_(S_, elastic ? S_.nx : 0),
      gradient_(S_, S_.v_rows()),
      defect_(S_, S_.interior()),
      step_(S_, S_.v_rows()),
      lambda_(S_, S_.interior()),
      gradient_q_(at(S_.nq)),
      step_q_(at(S_.nq)),
      residual_q_(at(S_.nq)),
      step_scalars_(scalar::first_global + at(S_.nq)),
      factor_sources_(source::first_class + 2 * at(S_.classes())),
      terminal_workspace_(make_workspace(terminal.workspace_size(8))),
      factor_workspace_(make_workspace(lane_count * elimination_.factor.slots())),
      reduce_workspace_(make_workspace(2 * lane_count * elimination_.reduce.slots())),
      expand_workspace_(make_workspace(2 * lane_count * elimination_.expand.slots())),
      terminal_hessian_(at((S_.nx + S_.nq) * (S_.nx + S_.nq))) {
    for (int i = 0; i < S_.nq; ++i) border_.push_back(riccati_.right_side());
    for (int c = 0; c < S_.classes(); ++c) {
        F_.emplace_back(S_, S_.nx);
    }
    for (int c = 0; c <= S_.classes(); ++c) {
        const int rows = c < S_.classes() ? S_.ng : static_cast<int>(S_.rates.size());
        groups.push_back({{S_, rows}, {S_, rows}, {S_, rows}, {S_, rows}, {S_, rows}});
        t_.emplace_back(S_, rows);
    }
    kept_ = direction();
    terminal_.prepare<8>(terminal_workspace_.get());
}

Direction Newton::direction() const {
    Direction d{{S_, S_.v_rows()}, {S_, S_.interior()}, std::vector<double>(at(S_.nq)), {}, {}};
    for (const Group& group : groups) d.equality.emplace_back(S_, group.weight.rows());
    d.pins.resize(pins.size());
    return d;
}

void Newton::clear_padding(RowBuffer& rows) const {
    const int end = padded8(S_.N) + 8;
    for (int i = 0; i < rows.rows(); ++i)
        std::fill(rows.row(i) + S_.N, rows.row(i) + std::min<std::ptrdiff_t>(end, rows.stride() - 8),
                  0.0);
}

void Newton::right_side(const RowBuffer& g, const RowBuffer& d, Riccati::RightSide& right,
                        double* g_q) {
    const StageLayout& layout = riccati_.layout();
    const double* sources[source::first_class] = {};
    sources[source::gradient] = g.origin();
    sources[source::defect] = d.origin();
    const double scalars[] = {regularisation, elastic_weight};
    for (int first = 0; first < S_.N; first += 2 * lane_count) {
        sources[source::segment] = segment_block(first);
        double* const w = reduce_workspace_.get();
        const int filled = std::min(2 * lane_count, S_.N - first);
        const Blocks blocks[] = {
            {right.stages.get() + at(first) * layout.vector_size(), layout.vector_size()}};
        elimination_.reduce.run({.sources = sources,
                                 .scalars = scalars,
                                 .first = first,
                                 .workspace = w,
                                 .blocks = blocks,
                                 .filled = filled,
                                 .stored_stride = lane_count * elimination_.segment_rows});
        for (std::size_t i = 0; i < elimination_.global_places.size(); ++i)
            for (int lane = 0; lane < filled; ++lane)
                g_q[i] += w[elimination_.reduce.entry(elimination_.global_places[i], lane)];
    }
    double* last = right.terminal.get();
    for (int i = 0; i < S_.nx; ++i) last[i] = g.row(S_.state_row(0, i))[S_.N];
    for (int i = 0; i < layout.ns - S_.nx; ++i)
        last[S_.nx + i] = S_.shared ? g.row(S_.control_row(0, i))[S_.N] : 0.0;
}

void Newton::read_step(const Riccati::RightSide& right, RowBuffer& step) {
    const StageLayout& layout = riccati_.layout();
    for (int k = 0; k <= S_.N; ++k) {
        const bool end = k == S_.N;
        const double* w = right.w.get() + k * layout.wp;
        const double* s = end ? right.last.get() : w + layout.vp;
        for (int i = 0; i < S_.nx; ++i) step.row(S_.state_row(0, i))[k] = s[i];
        if (S_.shared)
            for (int i = 0; i < S_.nu; ++i) step.row(S_.control_row(0, i))[k] = s[S_.nx + i];
        if (end) break;
        for (int c = S_.shared ? 1 : 0; c < S_.own_controls(); ++c)
            for (int i = 0; i < S_.nu; ++i)
                step.row(S_.control_row(c, i))[k] = w[S_.v_control(c, i)];
        if (elastic_)
            for (int i = 0; i < S_.nx; ++i)
                elastic_step_.row(i)[k] = w[S_.own_controls() * S_.nu + i];
        const double* costate = right.costate.get() + (k + 1) * layout.sp;
        for (int i = 0; i < S_.nx; ++i) costate_.row(i)[k] = costate[i];
    }
}

void Newton::structured_solve(const RowBuffer& g, const double* g_q, const RowBuffer& d,
                              RowBuffer& step, double* step_q, RowBuffer& lambda) {
    ++solves;
    const StageLayout& layout = riccati_.layout();
    const int nq = S_.nq;
    std::vector<double>& right_q = gradient_q_;
    std::copy_n(g_q, at(nq), right_q.begin());
    right_side(g, d, main_, right_q.data());
    riccati_.backward(main_);
    riccati_.forward(main_);
    if (nq > 0) {
        for (int a = 0; a < nq; ++a) step_q[a] = -(right_q[at(a)] + border_product(main_, a));
        for (int i = 0; i < nq; ++i) {
            for (int l = 0; l < i; ++l) step_q[i] -= schur_[at(i * nq + l)] * step_q[l];
            step_q[i] /= schur_[at(i * nq + i)];
        }
        for (int i = nq - 1; i >= 0; --i) {
            for (int l = i + 1; l < nq; ++l) step_q[i] -= schur_[at(l * nq + i)] * step_q[l];
            step_q[i] /= schur_[at(i * nq + i)];
        }
        for (int a = 0; a < nq; ++a) {
            const Riccati::RightSide& column = border_[at(a)];
            const auto add = [&](Workspace& to, const Workspace& from, int count) {
                for (int i = 0; i < count; ++i) to[at(i)] += step_q[a] * from[at(i)];
            };
            add(main_.w, column.w, S_.N * layout.wp);
            add(main_.last, column.last, layout.sp);
            add(main_.costate, column.costate, (S_.N + 1) * layout.sp);
        }
    }
    read_step(main_, step);
    const double* sources[source::first_class] = {};
    sources[source::gradient] = g.origin();
    sources[source::defect] = d.origin();
    sources[source::step] = step.origin();
    sources[source::elastic] = elastic_step_.origin();
    sources[source::costate] = costate_.origin();
    std::vector<double>& scalars = step_scalars_;
    scalars[scalar::regularisation] = regularisation;
    scalars[scalar::elastic_weight] = elastic_weight;
    std::copy_n(step_q, at(nq), scalars.begin() + scalar::first_global);
    for (int first = 0; first < S_.N; first += 2 * lane_count) {
        sources[source::segment] = segment_block(first);
        double* const targets[] = {nullptr, step.origin(), lambda.origin()};
        elimination_.expand.run({.sources = sources,
                                 .targets = targets,
                                 .scalars = scalars.data(),
                                 .first = first,
                                 .workspace = expand_workspace_.get(),
                                 .filled = std::min(2 * lane_count, S_.N - first),
                                 .stored_stride = lane_count * elimination_.segment_rows});
    }
    clear_padding(lambda);
    for (int row = S_.nx; row < S_.interior(); ++row)
        std::fill(step.row(row) + S_.N, step.row(row) + step.stride() - 8, 0.0);
}

void Newton::apply_rows(const RowBuffer& v, const double* q) {
    for (int c = 0; c < S_.classes(); ++c) points_.path_products(c, v, q, groups[at(c)].linear);
    points_.rates(v, q, groups.back().linear);
}

// Residual of the unreduced system at `at`: into gradient_, residual_q_ and defect_.
double Newton::residual(const RowBuffer& r, const double* r_q, const RowBuffer& d,
                        Direction& now) {
    for (int row = 0; row < S_.v_rows(); ++row) {
        const double *from = r.row(row), *weight = weight_v.row(row), *step = now.v.row(row);
        assign(S_.count(row), gradient_.row(row), [=, this](auto read) SKYKNOT_LAMBDA {
            return read(from) + (read(weight) + regularisation) * read(step);
        });
    }
    std::vector<double>& out_q = residual_q_;
    for (int i = 0; i < S_.nq; ++i)
        out_q[at(i)] = r_q[i] + (weight_q[at(i)] + regularisation) * now.q[at(i)];
    points_.rates(now.v, now.q.data(), groups.back().linear);
    for (int c = 0; c < S_.classes(); ++c) {
        const std::size_t C = at(c);
        points_.add_products(c, now.v, now.q.data(), now.lambda,
                             {groups[C].weight, now.equality[C], groups[C].linear}, F_[C],
                             gradient_, out_q.data());
    }
    Group& rate = groups.back();
    for (int i = 0; i < rate.weight.rows(); ++i)
        for (int k = 0; k < S_.N; ++k)
            t_.back().row(i)[k] = rate.weight.row(i)[k] * rate.linear.row(i)[k] +
                                  now.equality.back().row(i)[k];
    points_.add_rates_transposed(t_.back(), gradient_, out_q.data());
    points_.add_C_transposed(now.lambda, gradient_);
    const int n = S_.nx + S_.nq;
    const auto terminal_step = [&](int i) {
        return i < S_.nx ? now.v.row(S_.state_row(0, i))[S_.N] : now.q[at(i - S_.nx)];
    };
    for (int i = 0; i < n; ++i) {
        double sum = 0.0;
        for (int j = 0; j < n; ++j) sum += terminal_hessian_[at(i * n + j)] * terminal_step(j);
        if (i < S_.nx) gradient_.row(S_.state_row(0, i))[S_.N] += sum;
        else out_q[at(i - S_.nx)] += sum;
    }
    for (std::size_t p = 0; p < pins.size(); ++p) gradient_.row(pins[p].row)[pins[p].k] += now.pins[p];
    points_.combine(now.v, F_, 0, &d, defect_);

    double most = largest_defect(defect_, S_);
    for (const Group& group : groups)
        for (int i = 0; i < group.weight.rows(); ++i)
            for (int k = 0; k <= S_.N; ++k)
                if (group.equality.row(i)[k] > 0.0)
                    most = std::max(most, std::abs(group.residual.row(i)[k] + group.linear.row(i)[k]));
    for (int i = 0; i < S_.nx; ++i)
        if (riccati_.fixed_first[at(i)]) gradient_.row(S_.state_row(0, i))[0] = 0.0;
    most = std::max(most, largest_gradient(gradient_, S_));
    for (double value : out_q) most = std::max(most, std::abs(value));
    return most;
}

// Equality rows as weighted rows of this pass: into gradient_ and residual_q_.
void Newton::add_equalities() {
    for (int c = 0; c <= S_.classes(); ++c) {
        const Group& group = groups[at(c)];
        for (int i = 0; i < group.weight.rows(); ++i)
            for (int k = 0; k <= S_.N; ++k)
                t_[at(c)].row(i)[k] =
                    group.equality.row(i)[k] * (group.residual.row(i)[k] + group.linear.row(i)[k]);
        if (c < S_.classes()) points_.add_path_adjoint(c, t_[at(c)], gradient_, residual_q_.data());
    }
    points_.add_rates_transposed(t_.back(), gradient_, residual_q_.data());
}

// Multipliers of equality rows from this pass's step: of the sum, rounding times the weight would
// remain.
void Newton::move_equalities(Direction& out) {
    apply_rows(step_, step_q_.data());
    for (int c = 0; c <= S_.classes(); ++c) {
        const Group& group = groups[at(c)];
        for (int i = 0; i < group.weight.rows(); ++i)
            for (int k = 0; k <= S_.N; ++k)
                out.equality[at(c)].row(i)[k] +=
                    t_[at(c)].row(i)[k] + group.equality.row(i)[k] * group.linear.row(i)[k];
    }
}

double Newton::solve(const RowBuffer& r, const double* r_q, const RowBuffer& d, Direction& out,
                     int refinements) {
    std::fill(out.pins.begin(), out.pins.end(), 0.0);
    for (RowBuffer& rows : out.equality) rows.clear();
    for (Group& group : groups) group.linear.clear();
    const double scale = std::max(largest_defect(d, S_), largest_gradient(r, S_));
    double left = 0.0, before = INFINITY;
    for (int pass = 0;; ++pass) {
        const RowBuffer *gradient = &gradient_, *defect = pass == 0 ? &d : &defect_;
        if (pass == 0) {
            if (weighted_) gradient_.copy(r);
            else gradient = &r;
            std::copy_n(r_q, at(S_.nq), residual_q_.begin());
        }
        if (weighted_) add_equalities();
        structured_solve(*gradient, residual_q_.data(), *defect, step_, step_q_.data(), lambda_);
        if (pass == 0) {
            out.v.copy(step_), out.lambda.copy(lambda_), out.q = step_q_;
        } else {
            out.v.add(step_), out.lambda.add(lambda_);
            for (int i = 0; i < S_.nq; ++i) out.q[at(i)] += step_q_[at(i)];
        }
        if (weighted_ || elastic_) move_equalities(out);
        // put pins back within the pass, so that the next one sees what that leaves
        for (std::size_t p = 0; p < pins.size(); ++p) {
            out.pins[p] += pin_weight * step_.row(pins[p].row)[pins[p].k];
            out.v.row(pins[p].row)[pins[p].k] = 0.0;
        }
        if (elastic_) return 0.0;  // a restoration step needs no refinement
        left = residual(r, r_q, d, out);
        if (left > before) {  // the last pass did harm
            copy_direction(kept_, out);
            apply_rows(out.v, out.q.data());
            left = before;
            break;
        }
        if (!(left > accuracy * scale) || pass >= refinements || left > 0.5 * before) break;
        before = left;
        copy_direction(out, kept_);
    }
    return scale > 0.0 ? left / scale : left;
}

}  // namespace skyknot::inline SKYKNOT_ISA
