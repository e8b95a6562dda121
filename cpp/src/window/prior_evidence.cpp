// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/prior_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fairlead::window {
namespace {

constexpr std::size_t kFactors = 16;
const double kSmallest = std::log(1.0 / 9.0);  // three times better than told, at most
const double kStep = std::log(1.6);

using Curve = std::array<double, kFactors>;

double log_factor(double index) { return kSmallest + index * kStep; }

/// Index of the maximum, between the samples by a parabola.
double peak(const Curve& curve) {
    const auto best = static_cast<std::size_t>(std::max_element(curve.begin(), curve.end()) - curve.begin());
    if (best == 0 || best + 1 == kFactors) return static_cast<double>(best);
    const double left = curve[best] - curve[best - 1];
    const double right = curve[best] - curve[best + 1];
    return static_cast<double>(best) + 0.5 * (left - right) / std::max(left + right, 1e-300);
}

/// First index, between the samples by a straight line, from which the curve is above the level.
double first_above(const Curve& curve, double level) {
    std::size_t i = 0;
    while (i + 1 < kFactors && curve[i] < level) ++i;
    if (i == 0) return 0.0;
    return static_cast<double>(i) - std::clamp((curve[i] - level) / (curve[i] - curve[i - 1]), 0.0, 1.0);
}

}  // namespace

PriorEvidence::PriorEvidence(int landmarks)
    : S_(3 * landmarks, 3 * landmarks), y_(3 * landmarks), cholesky_(3 * landmarks) {}

PriorFactors PriorEvidence::evaluate(const LandmarkPrior& prior, const MatX& A, const VecX& b) noexcept {
    Curve evidence;
    Curve posterior;
    const auto scaled = static_cast<double>((prior.information.diagonal().array() > 0.0).count());
    for (std::size_t i = 0; i < kFactors; ++i) {
        const double log_q = log_factor(static_cast<double>(i));
        S_ = std::exp(-log_q) * prior.information;
        S_ += A;
        if (!cholesky_.factor(S_)) return {};
        y_ = b;
        cholesky_.L().solveInPlace(y_);
        evidence[i] = 0.5 * y_.squaredNorm() - cholesky_.half_log_det() - 0.5 * scaled * log_q;
        if (!std::isfinite(evidence[i])) return {};
        posterior[i] = evidence[i] - 0.5 * kPriorBelief * (log_q + std::exp(-log_q));
    }
    const double level = *std::max_element(evidence.begin(), evidence.end()) - kCredibleNats;
    PriorFactors factors;
    factors.likely = std::exp(log_factor(peak(posterior)));
    factors.believed = std::min(factors.likely, std::exp(log_factor(first_above(evidence, level))));
    return factors;
}

}  // namespace fairlead::window
