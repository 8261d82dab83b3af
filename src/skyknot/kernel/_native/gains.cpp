// Feedback gains K_k, δu_k = −K_k δx_k, from the last factorisation.
//
// Legend: P cost-to-go in s_k, H what node k adds to the Hessian over (x, u).
// A held control is the first entry of its stage's own policy. A control shared by two segments is
// judged by what lies ahead: P_k counts all of H, so the share of the segment behind is taken out
// before minimising over u_k. At the last node nothing lies ahead, and there is no gain.
#include <vector>

#include "newton.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// K = R⁻¹ S for positive definite R (n, n) and S (n, columns), row-major, both overwritten.
void divide(std::vector<double>& R, std::vector<double>& S, int n, int columns, double* K) {
    for (int j = 0; j < n; ++j)
        for (int i = j + 1; i < n; ++i) {
            const double factor = R[at(i * n + j)] / R[at(j * n + j)];
            for (int c = j; c < n; ++c) R[at(i * n + c)] -= factor * R[at(j * n + c)];
            for (int c = 0; c < columns; ++c)
                S[at(i * columns + c)] -= factor * S[at(j * columns + c)];
        }
    for (int i = n - 1; i >= 0; --i)
        for (int c = 0; c < columns; ++c) {
            double sum = S[at(i * columns + c)];
            for (int l = i + 1; l < n; ++l) sum -= R[at(i * n + l)] * K[l * columns + c];
            K[i * columns + c] = sum / R[at(i * n + i)];
        }
}

}  // namespace

void Riccati::policy(int k, int rows, double* K) const {
    const int nx = layout_.nx, nv = layout_.nv, vp = layout_.vp, wp = layout_.wp;
    std::vector<double> v(at(nv));
    for (int j = 0; j < nx; ++j) {  // v = L⁻ᵀ L_svᵀ s
        for (int p = nv - 1; p >= 0; --p) {
            double sum = L(k)[p * wp + vp + j];
            for (int i = p + 1; i < nv; ++i) sum -= L(k)[p * wp + i] * v[at(i)];
            v[at(p)] = sum / L(k)[p * wp + p];
        }
        for (int i = 0; i < rows; ++i) K[i * nx + j] = v[at(i)];
    }
}

// Rows of u of H at node k: (nu, nx + nu), row-major.
std::vector<double> Newton::node_control_rows(int k) const {
    const int nx = S_.nx, nu = S_.nu, width = nx + nu;
    std::vector<double> H(at(nu * width));
    const auto add = [&](int a, int b, double value) {
        if (a >= nx && a < width && b < width) H[at((a - nx) * width + b)] += value;
    };
    visit_node_hessian(k, add);
    for (int i = 0; i < nu; ++i)
        add(nx + i, nx + i, weight_v.row(S_.control_row(0, i))[k] + regularisation);
    return H;
}

void Newton::gains(int k, double* K) const {
    const int nx = S_.nx, nu = S_.nu, width = nx + nu, sp = riccati_.layout().sp;
    if (!S_.shared) return riccati_.policy(k, nu, K);
    const double* length = points_.length.row(0);
    const double behind = k == 0 ? 0.0 : length[k - 1] / (length[k - 1] + length[k]);
    const std::vector<double> H = node_control_rows(k);
    const double* P = riccati_.cost_to_go(k);
    std::vector<double> R(at(nu * nu)), S(at(nu * nx));
    for (int i = 0; i < nu; ++i) {
        for (int j = 0; j < nu; ++j)
            R[at(i * nu + j)] = P[(nx + j) * sp + nx + i] - behind * H[at(i * width + nx + j)];
        for (int j = 0; j < nx; ++j)
            S[at(i * nx + j)] = P[j * sp + nx + i] - behind * H[at(i * width + j)];
    }
    divide(R, S, nu, nx, K);
}

}  // namespace skyknot::inline SKYKNOT_ISA
