// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fairlead {
namespace {

double log_binomial(double n, double k) noexcept {
    return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

}  // namespace

double chance_consensus(const Camera& camera, std::span<const Observation> inflated, int inliers,
                        double gate) noexcept {
    const double image = static_cast<double>(camera.width) * static_cast<double>(camera.height);
    const double n = static_cast<double>(inflated.size());
    double p = 0.0;
    for (const Observation& o : inflated)
        p += std::min(1.0, std::numbers::pi * gate * std::sqrt(o.covariance.determinant()) / image) / n;
    p = std::clamp(p, 1e-300, 1.0 - 1e-12);
    double tail = 0.0;
    for (double m = inliers - 3.0; m <= n - 3.0; m += 1.0)
        tail += std::exp(log_binomial(n - 3.0, m) + m * std::log(p) + (n - 3.0 - m) * std::log1p(-p));
    return 4.0 * std::exp(log_binomial(n, 3.0)) * tail;
}

}  // namespace fairlead
