// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/covariance.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::window {
namespace {

/// E[s | s <= a] / 2 for Gaussian errors: what is left of their variance within the threshold, docs/estimator.md eq.
/// (15).
double gaussian_consistency(double a) noexcept { return std::isinf(a) ? 1.0 : 1.0 - 0.5 * a / std::expm1(0.5 * a); }

/// 99.99 % point of chi-square (Wilson and Hilferty 1931), within 2 % from one degree of freedom on.
double chi_square_limit(double freedom) noexcept {
    const double variance = 2.0 / (9.0 * freedom);
    return freedom * std::pow(1.0 - variance + 3.719016485 * std::sqrt(variance), 3);
}

}  // namespace

double structure_covariance(const Problem& problem, Workspace& workspace, MatX& Sigma) noexcept {
    Sigma.setIdentity();
    workspace.cholesky.solve_in_place(Sigma);
    const double parameters = 3.0 * problem.landmarks();
    if (!problem.prior) return parameters;
    const auto [believed, likely] = problem.prior_factors;
    workspace.product.noalias() = problem.prior->information * Sigma;
    const double told = workspace.product.trace() / believed + problem.prior->aside.dot(Sigma.diagonal());
    const double determined = std::clamp(parameters - told, 0.0, parameters);
    if (likely > believed) {
        const double excess = (likely - believed) / (believed * believed);
        workspace.S = Sigma;  // is in its factor already
        Sigma.noalias() += excess * workspace.S * workspace.product;
    }
    for (Eigen::Index c = 0; c < Sigma.cols(); ++c)
        for (Eigen::Index r = 0; r < c; ++r) Sigma(r, c) = Sigma(c, r) = 0.5 * (Sigma(r, c) + Sigma(c, r));
    return determined;
}

StateMatrix state_covariance(const ViewBlock& view, std::span<const Vec3> X_target, const MatX& Sigma,
                             double pose_factor, MatX& Yt, MatX& SigmaYt) noexcept {
    Yt.setZero();
    for (const PointTerm& term : view.terms) {
        const StateByPoint rows = reduced_rows(view, term, X_target[static_cast<std::size_t>(term.landmark)]);
        Yt.block<3, ViewState::kDim>(3 * term.landmark, 0) += rows;
        if (term.bias >= 0) Yt.row(3 * term.bias) += term.along.transpose() * rows;
    }
    for (Eigen::Index c = 0; c < ViewState::kDim; ++c) SigmaYt.col(c).noalias() = Sigma * Yt.col(c);
    StateMatrix inner = Yt.transpose() * SigmaYt;
    inner.diagonal().array() += pose_factor * view.share;  // this one view errs as told, however alike its neighbours
    const StateMatrix covariance = view.L_inverse.transpose() * inner * view.L_inverse;
    return 0.5 * (covariance + covariance.transpose());
}

void update_noise_factor(Problem& problem, double determined) noexcept {
    double squares = 0.0;
    double inliers = 0.0;
    double views = 0.0;
    for (const ViewBlock& view : problem.views) {
        squares += view.inlier_squares;
        inliers += view.inliers;
        views += view.share;
    }
    for (CompressedViews& compressed : problem.compressed) {
        if (compressed.empty()) continue;
        squares += compressed.value(problem.X);
        inliers += compressed.inliers();
        views += compressed.views();
    }
    squares = std::max(squares, 0.0) / gaussian_consistency(problem.loss.threshold);
    const double poses = ViewState::kDim * views;
    const double freedom = std::max(2.0 * inliers - poses - determined, 0.0);
    const double shared = (problem.design_effect - 1.0) * poses;
    const double factor = (kNoiseBelief + squares) / (kNoiseBelief + freedom);
    const double own = (kNoiseBelief + std::max(freedom - shared, 0.0)) / (kNoiseBelief + freedom);
    problem.noise_factor = factor;
    problem.pose_factor = problem.design_effect * std::max(factor, std::min(1.0, factor / own));
}

bool contradicts_prior(const Problem& problem, double determined) noexcept {
    return problem.prior && squared_distance(*problem.prior, problem.X) > chi_square_limit(std::max(1.0, determined));
}

void update_prior_factors(Problem& problem, const Quadratic& data, Workspace& workspace) noexcept {
    if (!problem.prior) return;
    const Eigen::Map<const VecX> x(data.X.front().data(), 3 * problem.landmarks());
    const double scale = 1.0 / problem.noise_factor;
    workspace.step = problem.prior->mean - x;
    workspace.D = -data.g;
    workspace.D.noalias() -= data.H.selfadjointView<Eigen::Lower>() * workspace.step;
    workspace.D *= scale;
    workspace.product = scale * data.H;
    workspace.product.diagonal() += problem.prior->aside;
    problem.prior_factors = workspace.evidence.evaluate(*problem.prior, workspace.product, workspace.D);
}

}  // namespace fairlead::window
