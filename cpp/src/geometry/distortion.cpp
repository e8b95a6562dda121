// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "distortion.hpp"

#include <cmath>

namespace fairlead::distortion {
namespace {

bool brown_conrady(const Camera& camera, const Vec2& m, Vec2& d, Mat22& J) noexcept {
    const std::array<double, 8>& k = camera.distortion;
    const bool rational = camera.model == CameraModel::rational;
    const double x = m.x(), y = m.y(), u = m.squaredNorm();
    if (!(u <= camera.radius_limit * camera.radius_limit) || camera.radius_limit <= 0.0) return false;
    const double p1 = k[2], p2 = k[3];
    const double N = 1.0 + u * (k[0] + u * (k[1] + u * k[4]));
    const double dN = k[0] + u * (2.0 * k[1] + u * 3.0 * k[4]);
    const double D = rational ? 1.0 + u * (k[5] + u * (k[6] + u * k[7])) : 1.0;
    const double dD = rational ? k[5] + u * (2.0 * k[6] + u * 3.0 * k[7]) : 0.0;
    const double s = N / D;
    const double ds = 2.0 * (dN - s * dD) / D;  // (ds/dr) / r
    Mat22 A;
    A(0, 0) = s + ds * x * x + 2.0 * p1 * y + 6.0 * p2 * x;
    A(0, 1) = ds * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
    A(1, 0) = A(0, 1);
    A(1, 1) = s + ds * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
    if (!(A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0) > 0.0)) return false;
    d << x * s + 2.0 * p1 * x * y + p2 * (u + 2.0 * x * x), y * s + p1 * (u + 2.0 * y * y) + 2.0 * p2 * x * y;
    J = A;
    return true;
}

bool equidistant(const Camera& camera, const Vec2& m, Vec2& d, Mat22& J) noexcept {
    const std::array<double, 8>& k = camera.distortion;
    const double u = m.squaredNorm(), r = std::sqrt(u);
    const double theta = std::atan(r);
    if (!(theta <= camera.radius_limit)) return false;
    const double t = theta * theta;
    const double factor = 1.0 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3])));
    const double slope = 1.0 + t * (3.0 * k[0] + t * (5.0 * k[1] + t * (7.0 * k[2] + t * 9.0 * k[3])));
    // s = theta_d / r; (ds/dr) / r is 0/0 at the centre, where it is multiplied by r^2 = 0.
    const double s = r > 0.0 ? theta * factor / r : 1.0;
    const double ds = u > 1e-24 ? (slope / (1.0 + u) - s) / u : 0.0;
    if (!(slope > 0.0 && factor > 0.0)) return false;
    d = s * m;
    J = s * Mat22::Identity() + ds * (m * m.transpose());
    return true;
}

}  // namespace

bool distort(const Camera& camera, const Vec2& m, Vec2& d, Mat22& J) noexcept {
    if (camera.model == CameraModel::pinhole) {
        d = m;
        J.setIdentity();
        return true;
    }
    return camera.model == CameraModel::equidistant ? equidistant(camera, m, d, J) : brown_conrady(camera, m, d, J);
}

double distorted_radius(const Camera& camera, double r) noexcept {
    const Radial f = radial(camera);
    return r * polynomial(f.numerator, r * r) / polynomial(f.denominator, r * r);
}

}  // namespace fairlead::distortion
