// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Single views of the batch: their first poses, second looks, and what each says as a whole.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "batch.hpp"

namespace fairlead {
namespace {

constexpr double kOtherPose = 0.05;  // [rad] by which another minimum differs
constexpr int kIterations = 8;       // of a view with the model
constexpr double kSettled = 1e-3;    // [sigma^2] step that ends them

}  // namespace

/// The pose of the view that is nearest in time to this one, of those that have one.
std::optional<Prediction> Batch::neighbour(const Candidate& candidate) const {
    std::optional<Prediction> pose;
    std::int64_t nearest = 0;
    for (const Candidate& other : candidates_) {
        const std::int64_t apart = std::abs(other.stamp_ns - candidate.stamp_ns);
        if (other.view < 0 || (pose && apart >= nearest)) continue;
        nearest = apart;
        pose = {problem_.views[static_cast<std::size_t>(other.view)].state.T_camera_target, Mat66::Identity()};
    }
    return pose;
}

/// Finds a first pose for every view that has none; true if any view was added. Where views are solved already, those
/// of few landmarks are predicted by their neighbours.
bool Batch::start_missing_views() {
    const bool solved = last_.ok;
    bool added = false;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
        Candidate& candidate = candidates_[k];
        if (candidate.view >= 0) continue;
        TrackerOptions options = options_;
        options.seed += k;
        const std::optional<Prediction> predicted = solved ? neighbour(candidate) : std::nullopt;
        const StartPose start = find_start(problem_.camera, model(), candidate.observations, predicted,
                                           problem_.noise_factor, options, scratch_);
        candidate.reason = start.reason;
        if (start.reason != Reason::none) continue;
        window::ViewBlock view(problem_.landmarks());
        view.stamp_ns = candidate.stamp_ns;
        view.state.T_camera_target = start.poses.best.T_camera_target;
        view.ranges = candidate.ranges;
        for (const Observation& o : candidate.observations)
            view.measurements.push_back({o.landmark, o.z, o.covariance.inverse()});
        candidate.view = static_cast<int>(problem_.views.size());
        problem_.views.push_back(std::move(view));
        added = true;
    }
    return added;
}

/// Of a pose, whatever the model may be within its covariance.
double Batch::doubted_cost(const Candidate& candidate, const SE3& T) {
    inflate(problem_.camera, model(), T, problem_.noise_factor, candidate.observations, scratch_);
    double cost = 0.0;
    for (const Observation& o : scratch_) {
        Vec2 z;
        if (!problem_.camera.project(T * problem_.X[static_cast<std::size_t>(o.landmark)], z)) continue;
        const Vec2 r = z - o.z;
        cost += Loss{options_.loss_threshold}.rho(r.dot(o.covariance.inverse() * r));
    }
    return cost;
}

/// Tries every view from its mirror image and from a fresh consensus on the present model; true if one of them costs
/// less. The best of the others is kept: it may be the right one.
bool Batch::take_second_look() {
    bool moved = false;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
        Candidate& candidate = candidates_[k];
        if (candidate.view < 0) continue;
        window::ViewBlock& view = problem_.views[static_cast<std::size_t>(candidate.view)];
        SE3& T = view.state.T_camera_target;
        TrackerOptions options = options_;
        options.seed += k + 7919;
        const StartPose fresh = find_start(problem_.camera, model(), candidate.observations, std::nullopt,
                                           problem_.noise_factor, options, scratch_);
        const SE3 starts[] = {pnp::mirrored(T, problem_.X, candidate.observations), fresh.poses.best.T_camera_target,
                              fresh.poses.other.T_camera_target};
        const double decided_before = decided(candidate);
        candidate.twin.reset();
        candidate.twin_nats = options_.ambiguity_log_odds;
        for (const SE3& start : starts) {
            const pnp::RefineResult other =
                pnp::refine(start, problem_.X, candidate.observations, problem_.camera, problem_.told_loss());
            if (!other.ok) continue;
            SE3 pose = other.T_camera_target;
            if (cost(view, pose) < cost(view, T) - 1e-3 * problem_.noise_factor) {
                std::swap(pose, T);
                moved = true;
            }
            const double nats = 0.5 * (doubted_cost(candidate, pose) - doubted_cost(candidate, T));
            if (nats >= candidate.twin_nats || difference(pose, T).tail<3>().norm() < kOtherPose) continue;
            candidate.twin = pose;
            candidate.twin_nats = std::max(nats, 0.0);
        }
        if (std::abs(decided(candidate) - decided_before) > 0.1) moved = true;
    }
    return moved;
}

/// A view errs as told, however much its errors are like those of others: its pose is what the whole view says with
/// all that was learned of the model, and with the likely prior, docs/motion.md eq. (13). The model has learned of
/// those errors already and is put back.
void Batch::locate_by_whole_views() {
    if (!window::linearise(problem_) || !window::assemble_data(problem_, 0.0, workspace_)) return;
    data_ = {workspace_.S, workspace_.g, problem_.X};
    const double cautious = std::exchange(problem_.prior_factors.believed, problem_.prior_factors.likely);
    for (Candidate& candidate : candidates_) {
        if (candidate.view < 0) continue;
        window::ViewBlock& view = problem_.views[static_cast<std::size_t>(candidate.view)];
        if (view.share < 1.0) locate(candidate, view);
        problem_.X = data_.X;
    }
    problem_.prior_factors.believed = cautious;
}

/// Gauss-Newton on one whole view and the model, everything else a quadratic.
void Batch::locate(Candidate& candidate, window::ViewBlock& view) {
    const double told = std::exchange(view.share, 1.0);
    const SE3 before = view.state.T_camera_target;
    bool ok = true;
    for (int iteration = 0; ok && iteration < kIterations; ++iteration) {
        ok = window::linearise(problem_.camera, problem_.X, problem_.told_loss(), problem_.noise_factor, view) &&
             window::factor_state(0.0, view);
        if (!ok) break;
        window::assemble(data_, problem_.X, workspace_);
        workspace_.eliminator.add(view, problem_.X, workspace_.S, workspace_.g);
        workspace_.eliminator.flush(workspace_.S);
        window::scale_and_add_prior(problem_, problem_.X, workspace_);
        ok = workspace_.cholesky.factor(workspace_.S);
        if (!ok) break;
        workspace_.dX = -workspace_.g;
        workspace_.cholesky.solve_in_place(workspace_.dX);
        const window::StateVector dT = window::back_substitute(view, problem_.X, workspace_.dX);
        const double states = (view.L_inverse * view.g).squaredNorm() / problem_.noise_factor;
        const double decrease = states - workspace_.g.dot(workspace_.dX);
        view.state.T_camera_target = perturb(view.state.T_camera_target, dT);
        for (std::size_t j = 0; j < problem_.X.size(); ++j)
            problem_.X[j] += workspace_.dX.segment<3>(3 * static_cast<Eigen::Index>(j));
        if (decrease < kSettled) break;
    }
    if (ok) {
        MatX Sigma(workspace_.S.rows(), workspace_.S.cols());
        window::structure_covariance(problem_, workspace_, Sigma);
        MatX Yt(Sigma.rows(), window::ViewState::kDim);
        MatX SigmaYt = Yt;
        candidate.whole = window::state_covariance(view, problem_.X, Sigma, problem_.pose_factor, Yt, SigmaYt);
    } else {
        view.state.T_camera_target = before;
    }
    view.share = told;
}

}  // namespace fairlead
