// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/density.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fairlead::motion {
namespace {

constexpr double kStep = 10.0;    // between neighbouring densities
constexpr int kBelow = 2;         // densities below the told one
constexpr double kMemory = 2.0;   // [s] over which likelihoods are forgotten
constexpr double kRecent = 0.4;   // [s] the same, so that the onset of a turn is not outvoted by the calm before it
constexpr double kBelief = 1.0;   // [nats] per decade by which the told density is preferred
constexpr double kSpeed = 200.0;  // [m/s] and
constexpr double kTurn = 50.0;    // [m/s^2] before anything was seen
constexpr double kRecentBelief = 3.0;  // [nats] the same for the short memory, which is noisy
constexpr double kCaution = 2.0;       // times the density that the likelihoods say: too rough costs little

}  // namespace

DensityBank::DensityBank(double told, int axes) : axes_(axes), told_(told), density_(told) {
    for (int i = 0; i < kFilters; ++i)
        filters_[static_cast<std::size_t>(i)].density = told * std::pow(kStep, i - kBelow);
}

void DensityBank::start(const Vec3& position, const Mat33& covariance) noexcept {
    for (Filter& filter : filters_) {
        filter.log_likelihood = filter.recent = 0.0;
        filter.mean.setZero(3 * axes_);
        filter.mean.head(axes_) = position.head(axes_);
        filter.covariance.setZero(3 * axes_, 3 * axes_);
        filter.covariance.topLeftCorner(axes_, axes_) = covariance.topLeftCorner(axes_, axes_);
        filter.covariance.diagonal().segment(axes_, axes_).setConstant(kSpeed * kSpeed);
        filter.covariance.diagonal().tail(axes_).setConstant(kTurn * kTurn);
    }
    density_ = told_;
    started_ = true;
}

void DensityBank::observe(double dt, const Vec3& position, const Mat33& covariance) noexcept {
    if (!started_) return start(position, covariance);
    const StateSquare Phi = transition(dt, axes_);
    for (Filter& filter : filters_) {
        const StateSquare L = noise_factor(dt, filter.density, axes_);
        filter.mean = (Phi * filter.mean).eval();
        filter.covariance = (Phi * filter.covariance * Phi.transpose() + L * L.transpose()).eval();
        const StateSquare S = filter.covariance.topLeftCorner(axes_, axes_) + covariance.topLeftCorner(axes_, axes_);
        const Eigen::LLT<StateSquare> llt(S);
        const State innovation = position.head(axes_) - filter.mean.head(axes_);
        const StateSquare gain_t = llt.solve(StateSquare(filter.covariance.topRows(axes_)));
        const double nis = innovation.dot(llt.solve(innovation));
        const double log_det = 2.0 * StateSquare(llt.matrixL()).diagonal().array().log().sum();
        const double news = -0.5 * (nis + log_det);
        filter.log_likelihood = std::exp(-dt / kMemory) * filter.log_likelihood + news;
        filter.recent = std::exp(-dt / kRecent) * filter.recent + news;
        filter.mean.noalias() += gain_t.transpose() * innovation;
        filter.covariance -= (gain_t.transpose() * S * gain_t).eval();
        filter.covariance = (0.5 * (filter.covariance + filter.covariance.transpose())).eval();
    }
    density_ = kCaution * std::max(mean(&Filter::log_likelihood), mean(&Filter::recent));
}

/// Geometric mean of the densities, weighed by likelihood and by how near they are to the told one.
double DensityBank::mean(double Filter::* log_likelihood) const noexcept {
    const double belief = log_likelihood == &Filter::recent ? kRecentBelief : kBelief;
    std::array<double, kFilters> weights;
    for (int i = 0; i < kFilters; ++i)
        weights[static_cast<std::size_t>(i)] =
            filters_[static_cast<std::size_t>(i)].*log_likelihood - belief * std::abs(i - kBelow);
    const double best = *std::max_element(weights.begin(), weights.end());
    double sum = 0.0;
    double log_density = 0.0;
    for (std::size_t i = 0; i < filters_.size(); ++i) {
        const double weight = std::exp(weights[i] - best);
        sum += weight;
        log_density += weight * std::log(filters_[i].density);
    }
    return std::exp(log_density / sum);
}

}  // namespace fairlead::motion
