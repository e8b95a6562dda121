// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/hypotheses.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

namespace fairlead {
namespace {

// The model's error is common to all views: evidence of older views counts less, so that it is not taken for
// independent.
constexpr double kMemory = 0.8;

}  // namespace

bool Hypotheses::consider(const pnp::PosePair& pair, double log_odds_limit) noexcept {
    active_ =
        pair.best.ok && pair.other.ok && pair.distinct && 0.5 * (pair.other.cost - pair.best.cost) < log_odds_limit;
    if (active_) {
        pose_[0] = pair.best;
        pose_[1] = pair.other;
        cost_[0] = pair.best.cost;
        cost_[1] = pair.other.cost;
    }
    return active_;
}

bool Hypotheses::update(const Camera& camera, const UncertainModel& model, std::span<const Observation> observations,
                        double noise_factor, const TrackerOptions& options,
                        std::vector<Observation>& scratch) noexcept {
    inflate(camera, model, pose_[0].T_camera_target, noise_factor, observations, scratch);
    const double least = options.min_inlier_ratio * static_cast<double>(observations.size());
    for (int i = 0; i < 2; ++i) {
        pose_[i] = pnp::refine(pose_[i].T_camera_target, model.X, scratch, camera, Loss{options.loss_threshold});
        pose_[i].ok = pose_[i].ok && pose_[i].inliers >= std::max(4.0, least);
        cost_[i] = kMemory * cost_[i] + pose_[i].cost;
    }
    const bool swap = !pose_[0].ok || (pose_[1].ok && cost_[1] < cost_[0]);
    if (swap) {
        std::swap(pose_[0], pose_[1]);
        std::swap(cost_[0], cost_[1]);
    }
    const bool merged = difference(pose_[0].T_camera_target, pose_[1].T_camera_target).tail<3>().norm() < 1e-3;
    active_ = pose_[0].ok && pose_[1].ok && !merged && 0.5 * (cost_[1] - cost_[0]) < options.ambiguity_log_odds;
    return pose_[0].ok;
}

Mat66 Hypotheses::covariance() const noexcept {
    const Mat66 covariance = pose_[0].information.llt().solve(Mat66::Identity());
    const Vec6 way = difference(pose_[0].T_camera_target, pose_[1].T_camera_target);
    const double p = 1.0 / (1.0 + std::exp(0.5 * (cost_[1] - cost_[0])));
    return covariance + p * way * way.transpose();
}

}  // namespace fairlead
