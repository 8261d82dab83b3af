// The shape of a program: sizes, scheme, sparsity, and where everything stands.
//
// Row buffers: quantity r of all segments (or nodes) stands in one row of `stride` doubles; a row
// pointer shows segment 0, with `front` zeros before it, so that neighbours are read by shifting.
//
// V rows (unknowns):   states of points 0 … s−2 (point 0 is the node), then control values.
// D rows (defects):    row i of the scheme, all states.
// Class rows (points): L, F, g, ∇L, ∂F, ∂g, H of one kind of evaluated point.
//
// y = (X_0 … X_{s−1}, U_0 … U_{m−1}, previous control, q) are the variables of one segment, and
// w = y without X_1 … X_{s−1} those left after elimination.
#pragma once

#include <cstddef>
#include <vector>

namespace skyknot::inline SKYKNOT_ISA {

struct Nonzeros {
    std::vector<int> row, column;
    std::size_t size() const { return row.size(); }
};

struct RateRow {
    int control;
    std::vector<double> weights;  // over U_0 … U_{m−1}; in carry mode over previous, U_0
};

struct Structure {
    int nx = 0, nu = 0, nq = 0, ng = 0;
    int np = 0;  // parameters: numbers that the point and terminal functions read
    int N = 0, s = 0, m = 0;
    bool shared = false;  // U_0 and U_{m−1} belong to the nodes
    bool carry = false;   // a held control whose rate is bounded: the previous one is a state
    std::vector<int> used;           // state points evaluated
    std::vector<double> C, A, W;     // (s−1, s), (s−1, used), (used, m)
    std::vector<int> gradient;       // columns of ∇L over (x, u, q)
    Nonzeros JF, Jg, H;              // over (x, u, q); H lower triangle
    std::vector<RateRow> rates;
    bool free_duration = false;

    static constexpr std::ptrdiff_t front = 8;
    std::ptrdiff_t stride() const { return (N + 1 + 15) / 16 * 16 + 2 * front; }

    int ny() const { return nx + nu + nq; }
    int interior() const { return (s - 1) * nx; }
    int own_controls() const { return shared ? m - 1 : m; }

    // V rows.
    int state_row(int point, int i) const { return point * nx + i; }
    int control_row(int value, int i) const { return (s - 1) * nx + value * nu + i; }
    int v_rows() const { return (s - 1) * nx + own_controls() * nu; }
    int count(int row) const {
        const bool node = row < nx || (shared && row >= interior() && row < interior() + nu);
        return node ? N + 1 : N;
    }

    // Classes of points: with shared controls the last point of a segment is the next node.
    int classes() const { return static_cast<int>(used.size()) - (shared ? 1 : 0); }
    int class_count(int c) const { return shared && c == 0 ? N + 1 : N; }
    int row_L() const { return 0; }
    int row_F() const { return 1; }
    int row_g() const { return 1 + nx; }
    int row_gradient() const { return row_g() + ng; }
    int row_JF() const { return row_gradient() + static_cast<int>(gradient.size()); }
    int row_Jg() const { return row_JF() + static_cast<int>(JF.size()); }
    int row_H() const { return row_Jg() + static_cast<int>(Jg.size()); }
    int class_rows() const { return row_H() + static_cast<int>(H.size()); }

    // Stage form: state s_k, control v_k.
    int ns() const { return nx + (shared || carry ? nu : 0); }
    int nv(bool elastic) const { return own_controls() * nu + (elastic ? nx : 0); }
    // v index of control value c of this segment (c ≥ 1 when shared).
    int v_control(int c, int i) const { return (shared ? c - 1 : c) * nu + i; }
    // v index that becomes carried entry i of the next stage state.
    int v_carried(int i) const { return v_control(m - 1, i); }
};

}  // namespace skyknot::inline SKYKNOT_ISA
