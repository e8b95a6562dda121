// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/geometry/se3.hpp"

#include <Eigen/LU>

namespace fairlead {

SE3 SE3::exp(const Vec6& xi) noexcept {
    const Vec3 phi = xi.tail<3>();
    return {so3::exp(phi), so3::left_jacobian(phi) * xi.head<3>()};
}

Vec6 SE3::log() const noexcept {
    const Vec3 phi = so3::log(R);
    // det V = 2 (1 - cos) / angle^2 >= 4 / pi^2 for |phi| <= pi, so the inverse always exists.
    const Mat33 V = so3::left_jacobian(phi);
    Vec6 xi;
    xi << V.inverse() * t, phi;
    return xi;
}

SE3 perturb(const SE3& T, const Vec6& xi) noexcept { return T * SE3::exp(xi); }

Vec6 difference(const SE3& a, const SE3& b) noexcept { return (a.inverse() * b).log(); }

}  // namespace fairlead
