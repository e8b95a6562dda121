// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/levenberg_marquardt.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::window {
namespace {

/// Solves the damped system for (dX, dT); false if singular.
bool solve(Problem& problem, double damping, Workspace& workspace) noexcept {
    if (!assemble_data(problem, damping, workspace)) return false;
    scale_and_add_prior(problem, problem.X, workspace);
    workspace.S.diagonal() += damping * workspace.D;
    workspace.llt.compute(workspace.S);
    if (workspace.llt.info() != Eigen::Success) return false;
    workspace.dX = -workspace.g;
    workspace.llt.solveInPlace(workspace.dX);
    for (std::size_t k = 0; k < problem.views.size(); ++k)
        workspace.dT[k] = back_substitute(problem.views[k], problem.X, workspace.dX);
    return workspace.dX.allFinite();
}

/// 1/2 (damping d^T D d - d^T g) of the full system, where -d^T g = -dX^T g_reduced + sum_k |L_k^-1 g_k|^2.
double predicted_decrease(const Problem& problem, double damping, const Workspace& workspace) noexcept {
    double states = 0.0;
    for (std::size_t k = 0; k < problem.views.size(); ++k) {
        const ViewBlock& view = problem.views[k];
        states += (view.L_inverse * view.g).squaredNorm();
        states += damping * workspace.dT[k].cwiseAbs2().dot(view.H.diagonal());
    }
    const double structure = damping * workspace.dX.cwiseAbs2().dot(workspace.D) - workspace.g.dot(workspace.dX);
    return 0.5 * (structure + states / problem.noise_factor);
}

void take_trial(Problem& problem, Workspace& workspace) noexcept {
    for (std::size_t j = 0; j < problem.X.size(); ++j)
        workspace.X_trial[j] = problem.X[j] + workspace.dX.segment<3>(3 * static_cast<Eigen::Index>(j));
    for (std::size_t k = 0; k < problem.views.size(); ++k)
        workspace.T_trial[k] = perturb(problem.views[k].state.T_camera_target, workspace.dT[k]);
}

void accept(Problem& problem, Workspace& workspace) noexcept {
    std::copy(workspace.X_trial.begin(), workspace.X_trial.end(), problem.X.begin());
    for (std::size_t k = 0; k < problem.views.size(); ++k)
        problem.views[k].state.T_camera_target = workspace.T_trial[k];
}

double current_cost(Problem& problem, Workspace& workspace) noexcept {
    for (std::size_t k = 0; k < problem.views.size(); ++k)
        workspace.T_trial[k] = problem.views[k].state.T_camera_target;
    return posterior_cost(problem, problem.X, workspace.T_trial);
}

}  // namespace

LmSummary levenberg_marquardt(Problem& problem, const LmOptions& options, Workspace& workspace) noexcept {
    workspace.dT.resize(problem.views.size());
    workspace.T_trial.resize(problem.views.size());
    LmSummary summary;
    if (!linearise(problem)) return summary;
    summary.initial_cost = summary.cost = current_cost(problem, workspace);
    double damping = options.initial_damping;
    double growth = 2.0;
    while (summary.iterations < options.max_iterations) {
        ++summary.iterations;
        const bool solved = solve(problem, damping, workspace);
        const double predicted = solved ? predicted_decrease(problem, damping, workspace) : 0.0;
        if (solved && predicted < options.tolerance * std::max(1.0, summary.cost)) {
            summary.converged = true;
            break;
        }
        double gain = -1.0;
        double trial_cost = 0.0;
        if (solved) {
            take_trial(problem, workspace);
            trial_cost = posterior_cost(problem, workspace.X_trial, workspace.T_trial);
            gain = std::isfinite(trial_cost) ? (summary.cost - trial_cost) / predicted : -1.0;
        }
        if (gain > 0.0) {
            accept(problem, workspace);
            summary.cost = trial_cost;
            damping *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3));
            growth = 2.0;
            if (!linearise(problem)) return summary;
        } else {
            damping *= growth;
            growth *= 2.0;
            if (damping > 1e12) break;
        }
    }
    summary.ok = std::isfinite(summary.cost);
    return summary;
}

}  // namespace fairlead::window
