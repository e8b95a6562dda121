// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/covariance.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::window {
namespace {

/// Exponential integral E1(x) for x >= 1 by its continued fraction (Abramowitz and Stegun 5.1.22).
double exponential_integral(double x) noexcept {
    double fraction = x;
    for (int k = 40; k >= 1; --k) fraction = x + k / (1.0 + k / fraction);
    return std::exp(-x) / fraction;
}

/// E[w s] / E[2 w] for Gaussian errors: what the robust loss takes from a variance estimate, docs/estimator.md eq.
/// (15).
double gaussian_consistency(double a) noexcept {
    if (!(a < 100.0)) return 1.0;
    const double tail = std::exp(-0.5 * a);
    const double e1 = exponential_integral(0.5 * a);
    const double squares = 2.0 - tail * (a + 2.0) + 0.5 * a * a * e1;
    const double weights = 1.0 - tail + 0.5 * a * a * (tail / a - 0.5 * e1);
    return squares / (2.0 * weights);
}

}  // namespace

double structure_covariance(const Problem& problem, Workspace& workspace, MatX& Sigma) noexcept {
    Sigma.setIdentity();
    workspace.cholesky.solve_in_place(Sigma);
    const double parameters = 3.0 * problem.landmarks();
    if (!problem.prior) return parameters;
    const auto [believed, likely] = problem.prior_factors;
    workspace.product.noalias() = problem.prior->information * Sigma;
    const double determined = std::clamp(parameters - workspace.product.trace() / believed, 0.0, parameters);
    if (likely > believed) {
        const double excess = (likely - believed) / (believed * believed);
        workspace.S = Sigma;  // is in its factor already
        Sigma.noalias() += excess * workspace.S * workspace.product;
    }
    return determined;
}

StateMatrix state_covariance(const ViewBlock& view, std::span<const Vec3> X_target, const MatX& Sigma,
                             double noise_factor, MatX& Yt, MatX& SigmaYt) noexcept {
    Yt.setZero();
    for (const PointTerm& term : view.terms)
        Yt.block<3, ViewState::kDim>(3 * term.landmark, 0) +=
            reduced_rows(view, term, X_target[static_cast<std::size_t>(term.landmark)]);
    for (Eigen::Index c = 0; c < ViewState::kDim; ++c) SigmaYt.col(c).noalias() = Sigma * Yt.col(c);
    StateMatrix inner = Yt.transpose() * SigmaYt;
    inner.diagonal().array() += noise_factor * view.share;  // this one view errs as told, however alike its neighbours
    const StateMatrix covariance = view.L_inverse.transpose() * inner * view.L_inverse;
    return 0.5 * (covariance + covariance.transpose());
}

void update_noise_factor(Problem& problem, double determined) noexcept {
    double squares = 0.0;
    double freedom = -determined;
    for (const ViewBlock& view : problem.views) {
        squares += view.weighted_squares;
        freedom += 2.0 * view.weights - ViewState::kDim * view.share;
    }
    for (CompressedViews& views : problem.compressed) {
        if (views.empty()) continue;
        squares += views.value(problem.X);
        freedom += 2.0 * views.weights() - ViewState::kDim * views.views();
    }
    squares = std::max(squares, 0.0) / gaussian_consistency(problem.loss.threshold);
    problem.noise_factor = (kNoiseBelief + squares) / (kNoiseBelief + std::max(freedom, 0.0));
}

void update_prior_factors(Problem& problem, const MatX& H, const VecX& g, std::span<const Vec3> X,
                          Workspace& workspace) noexcept {
    if (!problem.prior) return;
    const Eigen::Map<const VecX> x(X.front().data(), 3 * problem.landmarks());
    const double scale = 1.0 / problem.noise_factor;
    workspace.step = problem.prior->mean - x;
    workspace.D = -g;
    workspace.D.noalias() -= H.selfadjointView<Eigen::Lower>() * workspace.step;
    workspace.D *= scale;
    workspace.product = scale * H;
    problem.prior_factors = workspace.evidence.evaluate(*problem.prior, workspace.product, workspace.D);
}

}  // namespace fairlead::window
