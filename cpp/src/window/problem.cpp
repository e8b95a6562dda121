// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/problem.hpp"

namespace fairlead::window {
namespace {

Eigen::Map<const VecX> stacked(std::span<const Vec3> X) {
    return {X.data()->data(), 3 * static_cast<Eigen::Index>(X.size())};
}

}  // namespace

Workspace::Workspace(int landmarks)
    : eliminator(landmarks),
      llt(3 * landmarks),
      evidence(landmarks),
      X_trial(static_cast<std::size_t>(landmarks), Vec3::Zero()) {
    product.setZero(3 * landmarks, 3 * landmarks);
    S.setZero(3 * landmarks, 3 * landmarks);
    for (VecX* vector : {&g, &dX, &D, &step}) vector->setZero(3 * landmarks);
}

double posterior_cost(Problem& problem, std::span<const Vec3> X, std::span<const SE3> T) noexcept {
    const Loss loss = problem.told_loss();
    double data = problem.compressed ? problem.compressed->value(X) : 0.0;
    for (std::size_t k = 0; k < problem.views.size(); ++k)
        data += view_cost(problem.camera, X, loss, T[k], problem.views[k]);
    double prior = 0.0;
    if (problem.prior) {
        const auto& information = problem.prior->information;
        const auto x = stacked(X);
        const auto& mean = problem.prior->mean;
        for (Eigen::Index c = 0; c < x.size(); ++c) prior += (x[c] - mean[c]) * information.col(c).dot(x - mean);
    }
    return 0.5 * (data / problem.noise_factor + prior / problem.prior_factors.believed);
}

bool linearise(Problem& problem) noexcept {
    const Loss loss = problem.told_loss();
    for (ViewBlock& view : problem.views)
        if (!linearise(problem.camera, problem.X, loss, view)) return false;
    if (problem.compressed) problem.compressed->linearise(problem.X);
    return true;
}

bool assemble_data(Problem& problem, double damping, Workspace& workspace) noexcept {
    workspace.S.setZero();
    workspace.g.setZero();
    workspace.D.setZero();
    for (ViewBlock& view : problem.views) {
        if (!factor_state(damping, view)) return false;
        workspace.eliminator.add(view, problem.X, workspace.S, workspace.g);
        for (std::size_t i = 0; i < view.terms.size(); ++i)
            workspace.D.segment<3>(3 * view.measurements[i].landmark) += view.terms[i].M.diagonal();
    }
    workspace.eliminator.flush(workspace.S);
    if (problem.compressed) {
        workspace.S += problem.compressed->hessian();
        workspace.g += problem.compressed->gradient();
        workspace.D += problem.compressed->hessian().diagonal();
    }
    return workspace.S.allFinite();
}

void scale_and_add_prior(const Problem& problem, std::span<const Vec3> X, Workspace& workspace) noexcept {
    const double data_scale = 1.0 / problem.noise_factor;
    workspace.S *= data_scale;
    workspace.g *= data_scale;
    workspace.D *= data_scale;
    if (!problem.prior) return;
    const double scale = 1.0 / problem.prior_factors.believed;
    workspace.S += scale * problem.prior->information;
    workspace.D += scale * problem.prior->information.diagonal();
    workspace.step = scale * (stacked(X) - problem.prior->mean);
    workspace.g.noalias() += problem.prior->information * workspace.step;
}

}  // namespace fairlead::window
