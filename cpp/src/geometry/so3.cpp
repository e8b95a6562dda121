// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/geometry/so3.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace fairlead::so3 {
namespace {

/// sin(t) / t.
double sinc(double t) noexcept { return std::abs(t) < 1e-4 ? 1.0 - t * t / 6.0 : std::sin(t) / t; }

/// (1 - cos t) / t^2, written without cancellation.
double versine(double t) noexcept {
    const double s = sinc(0.5 * t);
    return 0.5 * s * s;
}

/// (t - sin t) / t^3; the series below 1/2, where its next term is under 1e-18.
double cubic(double t) noexcept {
    const double u = t * t;
    if (u >= 0.25) return (t - std::sin(t)) / (t * u);
    double sum = 1.0;
    for (int k = 8; k >= 2; --k) sum = 1.0 - u * sum / ((2.0 * k) * (2.0 * k + 1.0));
    return sum / 6.0;
}

}  // namespace

Mat33 exp(const Vec3& phi) noexcept {
    const double angle = phi.norm();
    const Mat33 A = hat(phi);
    return Mat33::Identity() + sinc(angle) * A + versine(angle) * (A * A);
}

Vec3 log(const Mat33& R) noexcept {
    const Eigen::Quaterniond q(R);
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;
    const Vec3 v = sign * q.vec();
    const double n = v.norm();
    const double w = sign * q.w();
    if (n < 1e-8) return (2.0 / w) * v;
    return (2.0 * std::atan2(n, w) / n) * v;
}

Mat33 left_jacobian(const Vec3& phi) noexcept {
    const double angle = phi.norm();
    const Mat33 A = hat(phi);
    return Mat33::Identity() + versine(angle) * A + cubic(angle) * (A * A);
}

Mat33 nearest(const Mat33& M) noexcept {
    const Eigen::JacobiSVD<Mat33> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat33 U = svd.matrixU();
    if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) *= -1.0;
    return U * svd.matrixV().transpose();
}

}  // namespace fairlead::so3
