// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/robust/loss.hpp"
#include "fairlead/window/state.hpp"

namespace fairlead::window {

/// Residuals r = pi(T X_j) - z_j of one view and their derivatives, docs/estimator.md eq. (4)-(6). Because the
/// perturbation is a motion of the target, d r / d xi = B [I, -hat(X_j)]: everything follows from M = w B^T S^-1 B and
/// v = w B^T S^-1 r of each landmark. False, block unusable, if fewer than three landmarks are in front of the camera.
/// noise_factor turns the covariance of a range into told units, by which the solver divides.
[[nodiscard]] bool linearise(const Camera& camera, std::span<const Vec3> X_target, const Loss& loss,
                             double noise_factor, ViewBlock& view) noexcept;

/// sum rho(s) at another pose, without derivatives. A landmark behind the camera costs 2 a, or infinity under least
/// squares.
[[nodiscard]] double view_cost(const Camera& camera, std::span<const Vec3> X_target, const Loss& loss,
                               double noise_factor, const SE3& T_camera_target, const ViewBlock& view) noexcept;

}  // namespace fairlead::window
