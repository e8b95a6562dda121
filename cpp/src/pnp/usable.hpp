// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

#include "fairlead/pnp/observation.hpp"

namespace fairlead::pnp {

/// Landmark exists and is finite, pixel finite, covariance finite and positive definite. What is not, is left out.
[[nodiscard]] inline bool is_usable(const Observation& observation, std::span<const Vec3> X_target) noexcept {
    if (observation.landmark < 0 || static_cast<std::size_t>(observation.landmark) >= X_target.size()) return false;
    const Mat22& S = observation.covariance;
    const double determinant = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
    const Vec3& X = X_target[static_cast<std::size_t>(observation.landmark)];
    return std::isfinite(X.sum() + observation.z.sum() + determinant) && S(0, 0) > 0.0 && determinant > 0.0;
}

/// Under least squares: what an observation behind the camera costs. Bounded losses have their own bound.
inline constexpr double kHiddenCost = 1e12;

/// s = r^T S^-1 r.
[[nodiscard]] inline double squared_residual(const Vec2& r, const Mat22& S) noexcept {
    const double u = r.x(), v = r.y();
    return (S(1, 1) * u * u - (S(0, 1) + S(1, 0)) * u * v + S(0, 0) * v * v) / (S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0));
}

}  // namespace fairlead::pnp
