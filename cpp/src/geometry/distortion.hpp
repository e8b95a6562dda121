// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "fairlead/geometry/camera.hpp"

namespace fairlead::distortion {

/// Distorted image point d of the ideal one m = (x / z, y / z) with J = dd/dm, docs/cameras.md eq. (3)-(6).
/// False, outputs untouched, beyond radius_limit or where the mapping turns over (det J <= 0).
[[nodiscard]] bool distort(const Camera& camera, const Vec2& m, Vec2& d, Mat22& J) noexcept;

/// Radius of the distorted image of a point at radius r, without tangential terms: r is tan theta, or theta where
/// equidistant.
[[nodiscard]] double distorted_radius(const Camera& camera, double r) noexcept;

/// First radius at which distorted_radius stops growing or has a pole, docs/cameras.md eq. (7); at most kRadiusCap, or
/// pi / 2 where equidistant.
[[nodiscard]] double radius_limit(const Camera& camera) noexcept;

/// Nothing flatter than this to the image plane is projected through a distorted camera: tan 89.994 degrees.
inline constexpr double kRadiusCap = 1e4;

/// Polynomial sum c_i u^i with exactly N coefficients.
template <std::size_t N>
[[nodiscard]] constexpr double polynomial(const std::array<double, N>& c, double u) noexcept {
    double sum = 0.0;
    for (std::size_t i = N; i-- > 0;) sum = sum * u + c[i];
    return sum;
}

/// Its derivative.
template <std::size_t N>
[[nodiscard]] constexpr std::array<double, N - 1> derivative(const std::array<double, N>& c) noexcept {
    std::array<double, N - 1> d{};
    for (std::size_t i = 1; i < N; ++i) d[i - 1] = static_cast<double>(i) * c[i];
    return d;
}

/// N(u) and D(u) of the radial factor N / D, u = r^2; equidistant: theta_d = theta N(theta^2).
struct Radial {
    std::array<double, 5> numerator{1.0, 0.0, 0.0, 0.0, 0.0};
    std::array<double, 5> denominator{1.0, 0.0, 0.0, 0.0, 0.0};
};
[[nodiscard]] Radial radial(const Camera& camera) noexcept;

}  // namespace fairlead::distortion
