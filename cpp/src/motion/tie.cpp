// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/tie.hpp"

#include <Eigen/LU>
#include <cmath>
#include <iterator>
#include <stdexcept>

namespace fairlead::motion {
namespace {

constexpr double kAttitudeCaution = 10.0;  // times the told sigma, docs/motion.md section 2
constexpr double kPositionFloor = 0.3;     // [rad] the same for the position in the target frame
constexpr double kAttitudeFloor = 0.01;    // [rad]

using Mat36 = Eigen::Matrix<double, 3, 6>;

Vec3 centroid(std::span<const Vec3> X) noexcept {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : X) centre += x / static_cast<double>(X.size());
    return centre;
}

/// Of the centroid in the camera frame by xi of T Exp(xi).
Mat36 point_rate(const SE3& T, const Vec3& X) noexcept {
    Mat36 J;
    J << T.R, -T.R * so3::hat(X);
    return J;
}

/// A quantity s * q that depends on pose and centroid through B = d q / d p: rows of B are the axes.
void measure_scaled(const SE3& T, std::span<const Vec3> X, const window::Slice& slice, const window::GaugeBasis& rate_t,
                    const Mat33& B, const Vec3& quantity, Tie& tie) noexcept {
    const double s = slice.similarity().s;
    tie.value = s * quantity;
    tie.J_pose = s * B * point_rate(T, centroid(X));
    const Mat33 each = (s / static_cast<double>(X.size())) * (B * T.R).transpose();
    tie.J_X_t.setZero();
    for (Eigen::Index j = 0; j < 3 * std::ssize(X); j += 3) tie.J_X_t.middleRows<3>(j) = each;
    tie.J_X_t.noalias() += rate_t.col(6) * (tie.value.transpose() / slice.radius());
}

void measure_position(const SE3& T, const window::Slice& slice, const window::GaugeBasis& rate_t, Tie& tie) noexcept {
    const window::Similarity& S = slice.similarity();
    const Vec3 c = -(T.R.transpose() * T.t);
    tie.value = S.s * (S.R * c) + S.t;
    tie.J_pose << -Mat33::Identity(), so3::hat(c);
    tie.J_pose = (S.s * S.R * tie.J_pose).eval();
    const Vec3 x = (tie.value - slice.centre()) / slice.radius();
    Eigen::Matrix<double, 3, 7> along;
    along << Mat33::Identity(), -so3::hat(x), x;
    tie.J_X_t.noalias() = rate_t * along.transpose();
    const Vec3 ray = (tie.value - slice.centre()).normalized();
    const double across = kPositionFloor * (tie.value - slice.centre()).norm();
    tie.covariance += across * across * (Mat33::Identity() - ray * ray.transpose());
    tie.information = tie.covariance.inverse();
}

}  // namespace

const char* to_string(Kind kind) noexcept {
    return kind == Kind::none ? "none" : kind == Kind::range ? "range" : kind == Kind::target ? "target" : "world";
}

Kind kind_named(const std::string& name) {
    for (const Kind kind : {Kind::none, Kind::range, Kind::target, Kind::world})
        if (name == to_string(kind)) return kind;
    throw std::invalid_argument("motion kind: got '" + name + "', expected none, range, target or world");
}

bool measure(Kind kind, const SE3& T, std::span<const Vec3> model, const window::Slice& slice,
             const window::GaugeBasis& gauge_rate_t, const std::optional<Attitude>& attitude, Tie& tie) noexcept {
    const std::span<const Vec3> X = slice.landmarks(model);
    const Vec3 p = T * centroid(X);
    const double range = p.norm();
    if (!(range > 0.0)) return false;
    tie.covariance = kRoughness_m * kRoughness_m * Mat33::Identity();
    tie.information = tie.covariance.inverse();
    switch (kind) {
        case Kind::none:
            return false;
        case Kind::range: {
            Mat33 B = Mat33::Zero();
            B.row(0) = p.transpose() / range;
            tie.information.diagonal().tail<2>().setZero();
            measure_scaled(T, X, slice, gauge_rate_t, B, Vec3(range, 0.0, 0.0), tie);
            return true;
        }
        case Kind::target:
            measure_position(T, slice, gauge_rate_t, tie);
            return true;
        case Kind::world: {
            if (!attitude) return false;
            const Mat33& R = attitude->R_world_camera;
            measure_scaled(T, X, slice, gauge_rate_t, R, R * p, tie);
            // An error of the attitude moves the centroid across the line of sight.
            const Vec3 along = R * p / range;
            const double across = range * std::hypot(kAttitudeCaution * attitude->sigma_rad, kAttitudeFloor);
            tie.covariance += across * across * (Mat33::Identity() - along * along.transpose());
            tie.information = tie.covariance.inverse();
            return true;
        }
    }
    return false;
}

}  // namespace fairlead::motion
