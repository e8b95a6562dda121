// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "distortion.hpp"

namespace fairlead::distortion {
namespace {

/// Zero of the polynomial between a and b, where its signs differ.
template <std::size_t N>
double bisect(const std::array<double, N>& c, double a, double b) noexcept {
    const bool rising = polynomial(c, a) < 0.0;
    while (true) {
        const double middle = 0.5 * (a + b);
        if (!(middle > a && middle < b)) return a;
        ((polynomial(c, middle) < 0.0) == rising ? a : b) = middle;
    }
}

/// Zeros with a change of sign in (0, end), ascending: between the zeros of the derivative a polynomial is monotonic.
template <std::size_t N>
std::array<double, N> zeros(const std::array<double, N>& c, double end) noexcept {
    std::array<double, N> found;
    found.fill(std::numeric_limits<double>::infinity());
    if constexpr (N > 1) {
        const std::array<double, N - 1> turns = zeros(derivative(c), end);
        std::size_t count = 0;
        double a = 0.0;
        for (std::size_t i = 0; i < N; ++i) {
            const double b = i + 1 < N ? std::min(turns[i], end) : end;
            if (polynomial(c, a) * polynomial(c, b) < 0.0) found[count++] = bisect(c, a, b);
            a = b;
        }
    }
    return found;
}

}  // namespace

Radial radial(const Camera& camera) noexcept {
    const std::array<double, 8>& k = camera.distortion;
    Radial f;
    if (camera.model == CameraModel::plumb_bob) f.numerator = {1.0, k[0], k[1], k[4], 0.0};
    if (camera.model == CameraModel::equidistant) f.numerator = {1.0, k[0], k[1], k[2], k[3]};
    if (camera.model == CameraModel::rational) {
        f.numerator = {1.0, k[0], k[1], k[4], 0.0};
        f.denominator = {1.0, k[5], k[6], k[7], 0.0};
    }
    return f;
}

double radius_limit(const Camera& camera) noexcept {
    const double cap = camera.model == CameraModel::equidistant ? 0.5 * std::numbers::pi : kRadiusCap;
    const Radial f = radial(camera);
    // d/dr [r N(u) / D(u)] = [N D + 2 u (N' D - N D')] / D^2 with u = r^2.
    std::array<double, 9> slope{};
    for (std::size_t i = 0; i < 5; ++i) {
        for (std::size_t j = 0; j < 5; ++j) {
            const double factor = 1.0 + 2.0 * (static_cast<double>(i) - static_cast<double>(j));
            slope[i + j] += factor * f.numerator[i] * f.denominator[j];
        }
    }
    const double fold = zeros(slope, cap * cap)[0];
    const double pole = zeros(f.denominator, cap * cap)[0];
    return std::min(cap, std::sqrt(std::min(fold, pole)));
}

}  // namespace fairlead::distortion
