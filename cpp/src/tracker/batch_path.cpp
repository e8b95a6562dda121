// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// The batch on a smooth path.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "batch.hpp"

namespace fairlead {
namespace {

constexpr int kRounds = 30;           // of path and model in turn, at most
constexpr double kSettled = 1e-6;     // [sigma^2] step of the model that ends them
constexpr double kTolerance = 1e-12;  // of a solution whose derivative is wanted

Eigen::Map<const VecX> stacked(const std::vector<Vec3>& X) {
    return {X.front().data(), 3 * static_cast<Eigen::Index>(X.size())};
}

}  // namespace

/// Views that the path can take go there, in the order of their stamps; the others stay.
void Batch::start_path() {
    std::vector<Vec3> X_ref;
    for (Eigen::Index j = 0; j < problem_.prior->mean.size(); j += 3)
        X_ref.emplace_back(problem_.prior->mean.segment<3>(j));
    const window::Gauge gauge = believed_ > 0 ? window::Gauge::rigid : window::Gauge::similarity;
    const window::Reference reference{X_ref, gauge, set_aside(options_)};
    path_.emplace(options_.motion, options_.jerk_density_m_s25, reference,
                  std::max<std::size_t>(1, problem_.views.size()));
    problem_.path.emplace(reference);
    int on_path = 0;
    std::vector<window::ViewBlock> others;
    for (Candidate* candidate : in_time()) {
        if (candidate->view < 0) continue;
        window::ViewBlock& view = problem_.views[static_cast<std::size_t>(candidate->view)];
        if (path_->append(view, candidate->attitude, problem_)) {
            candidate->on_path = on_path++;
        } else {
            candidate->view = static_cast<int>(others.size());
            others.push_back(std::move(view));
        }
    }
    problem_.views = std::move(others);
    settle_on_path();
}

/// Path and model in turn: the path at the model as it is, then the model with poses and motions eliminated.
void Batch::settle_on_path() {
    for (int round = 0; round < kRounds; ++round) {
        path_->smooth(problem_);
        path_->marginal(workspace_.product, workspace_.D);
        problem_.path->replace(workspace_.product, workspace_.D, problem_.noise_factor);
        const VecX before = stacked(problem_.X);
        last_ = window::levenberg_marquardt(problem_, {.tolerance = kTolerance}, workspace_);
        iterations_ += last_.iterations;
        if (!last_.ok || !window::assemble_data(problem_, 0.0, workspace_)) return;
        measure_structure();
        const VecX step = workspace_.cholesky.L_transposed() * (stacked(problem_.X) - before);
        last_.converged = step.squaredNorm() < kSettled;
        if (last_.converged) break;
    }
    path_->smooth(problem_);
}

/// Of images, readings and prior.
double Batch::cost_without_motion() {
    double on_path = 0.0;
    for (const Candidate& candidate : candidates_)
        if (candidate.on_path >= 0) on_path += cost(block(candidate), block(candidate).state.T_camera_target);
    problem_.path.reset();
    if (!window::linearise(problem_)) return std::numeric_limits<double>::quiet_NaN();
    return window::posterior_cost(problem_) + 0.5 * on_path / problem_.noise_factor;
}

}  // namespace fairlead
