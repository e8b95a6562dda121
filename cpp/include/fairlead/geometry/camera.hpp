// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <span>

#include "fairlead/geometry/types.hpp"

namespace fairlead {

enum class CameraModel { pinhole, plumb_bob, rational, equidistant };

/// A central camera. Pixel (0, 0) is the centre of the top-left pixel.
/// distortion: plumb_bob k1 k2 p1 p2 k3; rational k1 k2 p1 p2 k3 k4 k5 k6; equidistant k1 k2 k3 k4 (theta polynomial).
/// Equations: docs/cameras.md eq. (1)-(6). Source: OpenCV calib3d manual; Kannala and Brandt 2006 eq. (6).
/// Build cameras with distortion by make_camera, which finds radius_limit; without it they project nothing.
struct Camera {
    CameraModel model = CameraModel::pinhole;
    int width = 0;
    int height = 0;
    double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
    std::array<double, 8> distortion{};
    double min_depth = 1e-6;  ///< [m] points nearer than this (along z) are not projected
    double radius_limit =
        -1.0;  ///< where the distortion folds back: tan theta [-], equidistant theta [rad]; docs/cameras.md eq. (7)

    /// z = pi(p_camera) [px]. False, z untouched, if depth < min_depth or not finite, or beyond the monotonic
    /// part of the distortion (where the model folds back onto the image).
    [[nodiscard]] bool project(const Vec3& p_camera, Vec2& z) const noexcept {
        if (model != CameraModel::pinhole) return project_distorted(p_camera, z, nullptr);
        if (!(p_camera.z() >= min_depth)) return false;
        const double inverse_depth = 1.0 / p_camera.z();
        const double u = fx * (p_camera.x() * inverse_depth) + cx;
        const double v = fy * (p_camera.y() * inverse_depth) + cy;
        if (!std::isfinite(u + v)) return false;
        z << u, v;
        return true;
    }

    /// As above with J = dz/dp_camera [px/m], docs/cameras.md eq. (8).
    [[nodiscard]] bool project(const Vec3& p_camera, Vec2& z, Mat23& J) const noexcept {
        if (model != CameraModel::pinhole) return project_distorted(p_camera, z, &J);
        if (!project(p_camera, z)) return false;
        const double inverse_depth = 1.0 / p_camera.z();
        J << fx * inverse_depth, 0.0, (cx - z.x()) * inverse_depth, 0.0, fy * inverse_depth,
            (cy - z.y()) * inverse_depth;
        return true;
    }

    /// Unit ray through pixel z. False, ray untouched, if the distortion cannot be inverted there.
    [[nodiscard]] bool unproject(const Vec2& z, Vec3& ray_camera) const noexcept;

  private:
    [[nodiscard]] bool project_distorted(const Vec3& p_camera, Vec2& z, Mat23* J) const noexcept;
};

/// Number of distortion coefficients of a model.
[[nodiscard]] int distortion_size(CameraModel model) noexcept;

/// The way to build a camera: sets radius_limit and validates; throws std::invalid_argument as validate does.
[[nodiscard]] Camera make_camera(CameraModel model, int width, int height, const Mat33& K,
                                 std::span<const double> distortion);

/// Throws std::invalid_argument, saying which field came with what value, unless the camera is usable.
void validate(const Camera& camera);

}  // namespace fairlead
