// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/pnp/observation.hpp"
#include "fairlead/robust/loss.hpp"

namespace fairlead::pnp {

struct RefineResult {
    SE3 T_camera_target;
    Mat66 information = Mat66::Zero();  ///< Gauss-Newton Hessian of xi in T Exp(xi), robust weights in it
    double cost = 0.0;                  ///< sum rho(s)
    int inliers = 0;                    ///< observations with s <= loss.threshold
    int iterations = 0;
    bool ok = false;  ///< finite, in front of the camera, full rank
};

/// argmin over T of sum_j rho(r_j^T S_j^-1 r_j), r_j = pi(T X_j) - z_j, by Levenberg-Marquardt from T_start. X is
/// indexed by observation.landmark. An observation behind the camera costs the loss's bound (or a large constant).
/// docs/pnp.md eq. (4).
[[nodiscard]] RefineResult refine(const SE3& T_start, std::span<const Vec3> X_target,
                                  std::span<const Observation> observations, const Camera& camera, const Loss& loss,
                                  int max_iterations = 20) noexcept;

}  // namespace fairlead::pnp
