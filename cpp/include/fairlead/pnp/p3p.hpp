// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "fairlead/geometry/se3.hpp"

namespace fairlead::pnp {

/// Poses T_camera_target with T X_i parallel to rays_i and in front of the camera; up to four.
/// Returns how many were written; 0 for collinear points or rays. docs/pnp.md section 1.
[[nodiscard]] int p3p(const std::array<Vec3, 3>& rays_camera, const std::array<Vec3, 3>& X_target,
                      std::span<SE3, 4> T_camera_target) noexcept;

}  // namespace fairlead::pnp
