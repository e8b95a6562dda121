// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/geometry/camera.hpp"
#include "fairlead/geometry/se3.hpp"

namespace fairlead::window {

/// One standard deviation of what no image can tell of a model: its common translation, rotation and scale.
struct GaugeSigma {
    Vec3 translation_m = Vec3::Zero();
    Vec3 rotation_rad = Vec3::Zero();
    double scale = 0.0;
};

/// Of a model with covariance Sigma: sqrt diag N^+ Sigma N^+T, docs/range.md eq. (3).
[[nodiscard]] GaugeSigma gauge_sigma(std::span<const Vec3> X, const MatX& Sigma);

/// What a view of all landmarks from T with this noise [px] would add to the information about the model, its pose
/// unknown: 1/2 log det(I + Sigma A) [nats], docs/range.md eq. (4).
[[nodiscard]] double predicted_gain(const Camera& camera, std::span<const Vec3> X, const MatX& Sigma,
                                    const SE3& T_camera_target, double sigma_px);

}  // namespace fairlead::window
