// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/hypotheses.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace fairlead {
namespace {

/// How much of the inflated covariances is common to all views: the model's error, and the noise that stays.
double common_share(std::span<const Observation> told, double noise_factor, std::span<const Observation> inflated,
                    const TrackerOptions& options) noexcept {
    if (std::max({options.correlation_time_s, options.correlation_angle_rad, options.correlation_log_range}) > 0.0)
        return 1.0;
    double noise = 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < told.size(); ++i) {
        noise += noise_factor * told[i].covariance.trace();
        all += inflated[i].covariance.trace();
    }
    return 1.0 - noise / all;
}

}  // namespace

Mat66 mixed(const Mat66& covariance, const SE3& T, const SE3& other, double nats) noexcept {
    const Vec6 way = difference(T, other);
    return covariance + way * way.transpose() / (1.0 + std::exp(nats));
}

bool Hypotheses::consider(const pnp::PosePair& pair, double log_odds_limit) noexcept {
    active_ =
        pair.best.ok && pair.other.ok && pair.distinct && 0.5 * (pair.other.cost - pair.best.cost) < log_odds_limit;
    if (active_) {
        pose_[0] = pair.best;
        pose_[1] = pair.other;
        cost_[0] = sum_[0] = pair.best.cost;
        cost_[1] = sum_[1] = pair.other.cost;
        common_ = 0.0;
    }
    return active_;
}

bool Hypotheses::update(const Camera& camera, const UncertainModel& model, std::span<const Observation> observations,
                        double noise_factor, const TrackerOptions& options,
                        std::vector<Observation>& scratch) noexcept {
    inflate(camera, model, pose_[0].T_camera_target, noise_factor, observations, scratch);
    common_ += common_share(observations, noise_factor, scratch, options);
    const double views_a_new_one = 1.0 + common_;
    const double least = options.min_inlier_ratio * static_cast<double>(observations.size());
    for (int i = 0; i < 2; ++i) {
        pose_[i] = pnp::refine(pose_[i].T_camera_target, model.X, scratch, camera, Loss{options.loss_threshold});
        pose_[i].ok = pose_[i].ok && pose_[i].inliers >= std::max(4.0, least);
        sum_[i] += pose_[i].cost;
        cost_[i] = sum_[i] / views_a_new_one;
    }
    const bool swap = !pose_[0].ok || (pose_[1].ok && cost_[1] < cost_[0]);
    if (swap) {
        std::swap(pose_[0], pose_[1]);
        std::swap(sum_[0], sum_[1]);
        std::swap(cost_[0], cost_[1]);
    }
    const bool merged = difference(pose_[0].T_camera_target, pose_[1].T_camera_target).tail<3>().norm() < 1e-3;
    active_ = pose_[0].ok && pose_[1].ok && !merged && 0.5 * (cost_[1] - cost_[0]) < options.ambiguity_log_odds;
    return pose_[0].ok;
}

Mat66 Hypotheses::covariance() const noexcept {
    const Mat66 covariance = pose_[0].information.llt().solve(Mat66::Identity());
    return mixed(covariance, pose_[0].T_camera_target, pose_[1].T_camera_target, 0.5 * (cost_[1] - cost_[0]));
}

}  // namespace fairlead
