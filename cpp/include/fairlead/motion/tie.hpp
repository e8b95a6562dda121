// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "fairlead/geometry/se3.hpp"
#include "fairlead/window/slice.hpp"

namespace fairlead::motion {

/// What is smooth, docs/motion.md section 1: the distance to the landmarks' centroid; the camera's position in the
/// target frame; or the centroid relative to the camera along axes of the world, where the camera's attitude is known.
enum class Kind { none, range, target, world };

[[nodiscard]] const char* to_string(Kind kind) noexcept;
/// Throws std::invalid_argument for another name.
[[nodiscard]] Kind kind_named(const std::string& name);
[[nodiscard]] constexpr int axes_of(Kind kind) { return kind == Kind::none ? 0 : kind == Kind::range ? 1 : 3; }

/// A camera's attitude in a world-aligned frame, one standard deviation per axis.
struct Attitude {
    Mat33 R_world_camera = Mat33::Identity();
    double sigma_rad = 0.0;
};

/// The smooth quantity of one view, aligned like the model so that the gauge does not change it, and how it depends on
/// pose and landmarks, docs/motion.md eq. (4)-(6). Unused rows are zero.
struct Tie {
    explicit Tie(int landmarks) : J_X_t(3 * landmarks, 3) { J_X_t.setZero(); }

    Vec3 value = Vec3::Zero();
    Eigen::Matrix<double, 3, 6> J_pose = Eigen::Matrix<double, 3, 6>::Zero();
    Eigen::Matrix<double, Eigen::Dynamic, 3> J_X_t;  ///< transposed
    Mat33 information = Mat33::Zero();               ///< of the path being this value [1/m^2]
    Mat33 covariance = Mat33::Zero();                ///< its inverse [m^2]
};

/// How far the path may be from smooth in one view, one standard deviation [m] and share of the range.
inline constexpr double kRoughness_m = 0.02;

/// slice linearised at X; gauge_rate_t from it. False if there is no tie (world without attitude, camera in the
/// centroid).
[[nodiscard]] bool measure(Kind kind, const SE3& T_camera_target, std::span<const Vec3> X, const window::Slice& slice,
                           const window::GaugeBasis& gauge_rate_t, const std::optional<Attitude>& attitude,
                           Tie& tie) noexcept;

}  // namespace fairlead::motion
