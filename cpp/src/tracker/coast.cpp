// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/coast.hpp"

#include <Eigen/Cholesky>

namespace fairlead {
namespace {

constexpr double kInterval = 0.5;       // [s] over which the rate is taken, so that pose noise does not pass for motion
constexpr double kMemory = 0.7;         // weight of what was known of the rate before
constexpr double kUnknownTurn = 0.2;    // [rad/s] assumed before two poses were seen
constexpr double kUnknownSpeed = 0.05;  // [1/s] of the range

}  // namespace

void Coast::restart(std::int64_t stamp_ns, const SE3& T, const Mat66& covariance) noexcept {
    stamp_ns_ = reference_ns_ = stamp_ns;
    T_ = reference_ = T;
    covariance_ = covariance;
    range_rate_ = 0.0;
    velocity_.setZero();
    Vec6 rate;
    rate << Vec3::Constant(kUnknownSpeed * T.t.norm()), Vec3::Constant(kUnknownTurn);
    rate_ = rate.cwiseAbs2().asDiagonal();
}

void Coast::observe(std::int64_t stamp_ns, const SE3& T, const Mat66& covariance) noexcept {
    stamp_ns_ = stamp_ns;
    T_ = T;
    covariance_ = covariance;
    const double interval = 1e-9 * static_cast<double>(stamp_ns - reference_ns_);
    if (interval < kInterval) return;
    velocity_ = difference(reference_, T) / interval;
    rate_ = kMemory * rate_ + (1.0 - kMemory) * velocity_ * velocity_.transpose();
    range_rate_ = (T.t.norm() - reference_.t.norm()) / interval;
    reference_ns_ = stamp_ns;
    reference_ = T;
}

Mat66 Coast::covariance(std::int64_t stamp_ns) const noexcept {
    const double age = age_s(stamp_ns);
    return covariance_ + age * age * rate_;
}

Estimate Coast::predict(Estimate estimate, double limit_s) const noexcept {
    const double age = age_s(estimate.stamp_ns);
    if (age < 0.0) return without_pose(estimate, Status::lost, Reason::stamp);
    if (age > limit_s) return without_pose(estimate, Status::lost, Reason::none);
    estimate.status = Status::coasting;
    estimate.T_camera_target = perturb(T_, age * velocity_);
    estimate.covariance = covariance(estimate.stamp_ns);
    return estimate;
}

void update_pose(const Camera& camera, const UncertainModel& model, std::span<const Observation> inflated, SE3& T,
                 Mat66& covariance) noexcept {
    const SE3 T_prior = T;
    const Mat66 prior = covariance.llt().solve(Mat66::Identity());
    for (int iteration = 0; iteration < 5; ++iteration) {
        Mat66 H = prior;
        Vec6 g = -(prior * difference(T, T_prior));
        for (const Observation& o : inflated) {
            const Vec3& X = model.X[static_cast<std::size_t>(o.landmark)];
            Vec2 z;
            Mat23 J;
            if (!camera.project(T * X, z, J)) continue;
            const Mat23 B = J * T.R;
            Mat26 J_pose;
            J_pose << B, -B * so3::hat(X);
            const Vec2 r = z - o.z;
            const Mat22 information = o.covariance.inverse();
            const double weight = Loss{}.weight(r.dot(information * r));
            H += weight * J_pose.transpose() * information * J_pose;
            g += weight * J_pose.transpose() * information * r;
        }
        const Eigen::LLT<Mat66> llt(H);
        const Vec6 step = -llt.solve(g);
        if (llt.info() != Eigen::Success || !step.allFinite()) return;
        T = perturb(T, step);
        covariance = llt.solve(Mat66::Identity());
    }
}

}  // namespace fairlead
