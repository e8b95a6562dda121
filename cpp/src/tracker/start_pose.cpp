// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/start_pose.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "fairlead/pnp/ransac.hpp"
#include "fairlead/tracker/evidence.hpp"

namespace fairlead {
namespace {

constexpr double kPredictionShare = 0.7;   // inliers that make a prediction good enough
constexpr double kFlat = 0.1;              // flatness below which a target has two poses in any view
constexpr double kMaxSurprise = 18.0;      // [-] squared distance from a prediction, which may be wrong
constexpr double kSamePose = 1e-3;         // [rad]
constexpr double kMaxChance = 0.1;         // consensus sets that chance may be expected to offer
constexpr double kMaxRotationSigma = 1.0;  // [rad] a pose less certain than this is no pose
constexpr double kMaxRangeSigma = 0.5;     // [-] of the range

const Vec3& landmark(const UncertainModel& model, const Observation& o) {
    return model.X[static_cast<std::size_t>(o.landmark)];
}

double median_of(std::vector<Observation>& o, double (*value)(const Observation&)) noexcept {
    const auto middle = o.begin() + static_cast<std::ptrdiff_t>(o.size() / 2);
    std::nth_element(o.begin(), middle, o.end(),
                     [&](const Observation& a, const Observation& b) { return value(a) < value(b); });
    return value(*middle);
}

/// Pixels per metre of the target as the view shows it, robust to outliers; an upper guess, since the image
/// foreshortens. o is consumed.
double pixels_per_metre(const UncertainModel& model, std::vector<Observation>& o) noexcept {
    Vec3 centre = Vec3::Zero();
    for (const Observation& p : o) centre += landmark(model, p) / static_cast<double>(o.size());
    double metres = 0.0;
    for (const Observation& p : o) metres += (landmark(model, p) - centre).norm() / static_cast<double>(o.size());
    const Vec2 middle(median_of(o, [](const Observation& p) { return p.z.x(); }),
                      median_of(o, [](const Observation& p) { return p.z.y(); }));
    for (Observation& p : o) p.z -= middle;
    return 2.0 * median_of(o, [](const Observation& p) { return p.z.norm(); }) / std::max(metres, 1e-12);
}

/// Before any pose is known: S = f S_j + (k sigma_j)^2 I.
void inflate_isotropic(const UncertainModel& model, double noise_factor, std::span<const Observation> observations,
                       std::vector<Observation>& out) noexcept {
    out.assign(observations.begin(), observations.end());
    const double k = pixels_per_metre(model, out);
    out.assign(observations.begin(), observations.end());
    for (Observation& o : out) {
        const double variance = model.covariance[static_cast<std::size_t>(o.landmark)].trace() / 3.0;
        o.covariance = noise_factor * o.covariance + k * k * variance * Mat22::Identity();
    }
}

bool well_determined(const pnp::RefineResult& pose) noexcept {
    const Eigen::LLT<Mat66> llt(pose.information);
    if (llt.info() != Eigen::Success) return false;
    const Mat66 covariance = llt.solve(Mat66::Identity());
    const double rotation = std::sqrt(covariance.bottomRightCorner<3, 3>().diagonal().maxCoeff());
    const double position = std::sqrt(covariance.topLeftCorner<3, 3>().diagonal().maxCoeff());
    return rotation < kMaxRotationSigma && position < kMaxRangeSigma * pose.T_camera_target.t.norm();
}

/// The other pose of a flat target too, less likely the further the prediction is from it: where the two were one, the
/// wrong one may have been followed since.
void add_mirrored(const UncertainModel& model, std::span<const Observation> observations, const Camera& camera,
                  const Loss& loss, const Prediction& predicted, StartPose& start) noexcept {
    const Eigen::LLT<Mat66> llt(predicted.covariance);
    const auto surprise = [&](const SE3& T) {
        const Vec6 xi = difference(predicted.T_camera_target, T);
        return std::min(xi.dot(llt.solve(xi)), kMaxSurprise);
    };
    const pnp::RefineResult followed = start.poses.best;
    start.poses = pnp::pose_pair(followed.T_camera_target, model.X, observations, camera, loss);
    auto& [best, other, distinct] = start.poses;
    if (!distinct) return;
    best.cost += surprise(best.T_camera_target);
    other.cost += surprise(other.T_camera_target);
    if (other.cost < best.cost) std::swap(best, other);
    const double turn = difference(followed.T_camera_target, best.T_camera_target).tail<3>().norm();
    start.from_prediction = turn < kSamePose;
}

}  // namespace

void inflate(const Camera& camera, const UncertainModel& model, const SE3& T_camera_target, double noise_factor,
             std::span<const Observation> observations, std::vector<Observation>& out) noexcept {
    out.assign(observations.begin(), observations.end());
    for (Observation& o : out) {
        Vec2 z;
        Mat23 J;
        o.covariance *= noise_factor;
        if (!camera.project(T_camera_target * landmark(model, o), z, J)) continue;
        const Mat23 B = J * T_camera_target.R;
        o.covariance += B * model.covariance[static_cast<std::size_t>(o.landmark)] * B.transpose();
    }
}

StartPose find_start(const Camera& camera, const UncertainModel& model, std::span<const Observation> observations,
                     const std::optional<Prediction>& predicted, double noise_factor, const TrackerOptions& options,
                     std::vector<Observation>& scratch) noexcept {
    StartPose start;
    const Loss loss{options.loss_threshold};
    const int n = static_cast<int>(observations.size());
    if (n < 4) return start.reason = Reason::too_few, start;
    const pnp::Spread spread = pnp::spread(model.X, observations);
    if (spread.straightness < 1e-6) return start.reason = Reason::degenerate, start;
    if (predicted) {
        inflate(camera, model, predicted->T_camera_target, noise_factor, observations, scratch);
        start.poses.best = pnp::refine(predicted->T_camera_target, model.X, scratch, camera, loss);
        start.from_prediction = start.poses.best.ok && start.poses.best.inliers >= std::max(4.0, kPredictionShare * n);
        if (start.from_prediction && spread.flatness < kFlat)
            add_mirrored(model, scratch, camera, loss, *predicted, start);
    }
    if (!start.from_prediction) {
        inflate_isotropic(model, noise_factor, observations, scratch);
        const pnp::RansacResult consensus = pnp::ransac(model.X, scratch, camera, loss, {.seed = options.seed});
        if (consensus.ok) {
            inflate(camera, model, consensus.pose.T_camera_target, noise_factor, observations, scratch);
            const pnp::PosePair pair = pnp::pose_pair(consensus.pose.T_camera_target, model.X, scratch, camera, loss);
            const bool prediction_wins = start.poses.best.ok && start.poses.best.cost < pair.best.cost;
            if (prediction_wins)
                start.from_prediction = true;
            else
                start.poses = pair;
        }
    }
    const pnp::RefineResult& best = start.poses.best;
    if (!best.ok || best.inliers < std::max(4.0, options.min_inlier_ratio * n))
        start.reason = Reason::no_consensus;
    else if (!start.from_prediction &&
             chance_consensus(camera, scratch, best.inliers, options.loss_threshold) > kMaxChance)
        start.reason = Reason::no_consensus;
    else if (!well_determined(best))
        start.reason = Reason::degenerate;
    return start;
}

}  // namespace fairlead
