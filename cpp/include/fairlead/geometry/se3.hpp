// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/geometry/so3.hpp"

namespace fairlead {

/// Rigid motion T_a_b: p_a = R p_b + t, CONVENTIONS.md eq. (1).
struct SE3 {
    Mat33 R = Mat33::Identity();
    Vec3 t = Vec3::Zero();

    [[nodiscard]] Vec3 operator*(const Vec3& p) const noexcept { return R * p + t; }
    [[nodiscard]] SE3 operator*(const SE3& other) const noexcept { return {R * other.R, R * other.t + t}; }
    [[nodiscard]] SE3 inverse() const noexcept { return {R.transpose(), -(R.transpose() * t)}; }

    /// Exp(xi), xi = [rho; phi]: R = Exp(phi), t = V(phi) rho, CONVENTIONS.md eq. (5).
    [[nodiscard]] static SE3 exp(const Vec6& xi) noexcept;

    /// Inverse of exp.
    [[nodiscard]] Vec6 log() const noexcept;
};

/// T_camera_target Exp(xi): the perturbation used everywhere, CONVENTIONS.md eq. (6).
[[nodiscard]] SE3 perturb(const SE3& T, const Vec6& xi) noexcept;

/// xi such that b = a Exp(xi).
[[nodiscard]] Vec6 difference(const SE3& a, const SE3& b) noexcept;

}  // namespace fairlead
