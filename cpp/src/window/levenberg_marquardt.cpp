// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/levenberg_marquardt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fairlead::window {
namespace {

/// Solves the damped system for (dX, dT); false if singular.
bool solve(Problem& problem, double damping, Workspace& workspace) noexcept {
    if (!assemble_data(problem, damping, workspace)) return false;
    scale_and_add_prior(problem, problem.X, workspace);
    workspace.S.diagonal() += damping * workspace.D;
    if (!workspace.cholesky.factor(workspace.S)) return false;
    workspace.dX = -workspace.g;
    workspace.cholesky.solve_in_place(workspace.dX);
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

void take_step(Problem& problem, Workspace& workspace) noexcept {
    for (std::size_t j = 0; j < problem.X.size(); ++j) {
        workspace.X_before[j] = problem.X[j];
        problem.X[j] += workspace.dX.segment<3>(3 * static_cast<Eigen::Index>(j));
    }
    for (std::size_t k = 0; k < problem.views.size(); ++k) {
        SE3& T = problem.views[k].state.T_camera_target;
        workspace.T_before[k] = T;
        T = perturb(T, workspace.dT[k]);
    }
}

void step_back(Problem& problem, const Workspace& workspace) noexcept {
    std::copy(workspace.X_before.begin(), workspace.X_before.end(), problem.X.begin());
    for (std::size_t k = 0; k < problem.views.size(); ++k)
        problem.views[k].state.T_camera_target = workspace.T_before[k];
}

/// E where the problem is, which is linearised there: most steps are good, and their costs come with the derivatives.
double linearised_cost(Problem& problem) noexcept {
    return linearise(problem) ? posterior_cost(problem) : std::numeric_limits<double>::infinity();
}

}  // namespace

LmSummary levenberg_marquardt(Problem& problem, const LmOptions& options, Workspace& workspace) noexcept {
    workspace.dT.resize(problem.views.size());
    workspace.T_before.resize(problem.views.size());
    LmSummary summary;
    summary.initial_cost = summary.cost = linearised_cost(problem);
    if (!std::isfinite(summary.cost)) return summary;
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
        double cost = summary.cost;
        if (solved) {
            take_step(problem, workspace);
            cost = linearised_cost(problem);
        }
        if (cost < summary.cost) {
            const double gain = (summary.cost - cost) / predicted;
            summary.cost = cost;
            damping *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3));
            growth = 2.0;
            continue;
        }
        if (solved) {
            step_back(problem, workspace);
            if (!linearise(problem)) return summary;
        }
        damping *= growth;
        growth *= 2.0;
        if (damping > 1e12) break;
    }
    summary.ok = true;
    return summary;
}

}  // namespace fairlead::window
