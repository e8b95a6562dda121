// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/refine.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "batch.hpp"
#include "fairlead/tracker/hypotheses.hpp"
#include "fairlead/tracker/readings.hpp"
#include "fairlead/window/gauge_curvature.hpp"

namespace fairlead {

const window::ViewBlock& Batch::block(const Candidate& candidate) const {
    if (candidate.on_path >= 0) return path_->view(static_cast<std::size_t>(candidate.on_path));
    return problem_.views[static_cast<std::size_t>(candidate.view)];
}

/// Of a pose, with what is not known of the model and of the range finder.
Mat66 Batch::covariance(const Candidate& candidate) const {
    if (candidate.on_path >= 0) return path_covariances_[static_cast<std::size_t>(candidate.on_path)];
    if (candidate.whole) return *candidate.whole;
    MatX Yt(Sigma_.rows(), window::ViewState::kDim);
    MatX SigmaYt = Yt;
    return window::state_covariance(block(candidate), problem_.X, Sigma_, problem_.pose_factor, Yt, SigmaYt);
}

/// With the landmarks that passed the chi-square gate of the view.
Estimate Batch::estimate(const Candidate& candidate, std::vector<int>& inliers) const {
    Estimate e;
    e.stamp_ns = candidate.stamp_ns;
    e.dropped = candidate.dropped;
    if (candidate.view < 0 || !last_.ok)
        return without_pose(e, Status::lost, candidate.reason == Reason::none ? Reason::diverged : candidate.reason);
    const window::ViewBlock& view = block(candidate);
    e.status = Status::tracking;
    e.reason =
        doubt(problem_.noise_factor, problem_.prior_factors.likely, window::contradicts_prior(problem_, determined_));
    e.T_camera_target = view.state.T_camera_target;
    e.covariance = covariance(candidate);
    if (candidate.twin && candidate.on_path < 0) {
        e.covariance = mixed(e.covariance, e.T_camera_target, *candidate.twin, candidate.twin_nats);
        if (e.reason == Reason::none) e.reason = Reason::ambiguous;
    }
    double squares = 0.0;
    for (const window::Measurement& m : view.measurements) {
        Vec2 z;
        if (!problem_.camera.project(e.T_camera_target * problem_.X[static_cast<std::size_t>(m.landmark)], z)) continue;
        const Vec2 r = z - m.z;
        if (r.dot(m.information * r) > options_.gate * problem_.noise_factor) continue;
        squares += r.squaredNorm();
        inliers.push_back(m.landmark);
    }
    e.inlier_landmarks = inliers;
    e.inliers = static_cast<int>(inliers.size());
    e.reprojection_rms_px = std::sqrt(squares / std::max(1.0, 2.0 * e.inliers));
    return e;
}

Refinement Batch::result() {
    Refinement refinement;
    if (path_) path_covariances_ = path_->covariances(problem_, Sigma_);
    refinement.inliers.resize(candidates_.size());
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        refinement.estimates.push_back(estimate(candidates_[k], refinement.inliers[k]));
    refinement.X.assign(problem_.X.begin(), problem_.X.begin() + static_cast<std::ptrdiff_t>(landmarks()));
    const Eigen::Index size = 3 * std::ssize(points());
    MatX Sigma = Sigma_.topLeftCorner(size, size);
    if (last_.ok) window::add_gauge_curvature(points(), Sigma);
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(landmarks());
    refinement.covariance = Sigma.topLeftCorner(n, n);
    refinement.noise_factor = problem_.noise_factor;
    refinement.prior_factor = problem_.prior_factors.likely;
    refinement.prior_factor_believed = problem_.prior_factors.believed;
    refinement.cost = path_ ? cost_without_motion() : last_.cost;
    refinement.iterations = iterations_;
    refinement.converged = last_.converged;
    refinement.ranges_believed = believed_;
    refinement.ranges_refused = refused_;
    refinement.range_bias = range_bias(options_, problem_.X, Sigma_);
    return refinement;
}

Refinement refine(const Camera& camera, std::span<const Vec3> X0, const MatX& P0, std::span<const BatchView> views,
                  const TrackerOptions& options, const BatchReadings& readings) {
    validate(camera);
    validate(options);
    require(X0.size() >= 4, "landmarks", std::to_string(X0.size()), "at least 4 (a pose needs them)");
    std::vector<Vec3> X(X0.begin(), X0.end());
    MatX P = P0;
    append_entries(options, X, P);
    Batch batch(camera, X, P, options);
    for (const BatchView& view : views) batch.add(view);
    batch.add(readings);
    return batch.solve();
}

}  // namespace fairlead
