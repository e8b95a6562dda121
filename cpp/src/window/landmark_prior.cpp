// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/landmark_prior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace fairlead::window {
namespace {

Vec3 centroid(std::span<const Vec3> X) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : X) sum += x;
    return sum / static_cast<double>(X.size());
}

double extent(std::span<const Vec3> X) {
    const Vec3 centre = centroid(X);
    double radius = 0.0;
    for (const Vec3& x : X) radius = std::max(radius, (x - centre).norm());
    return radius;
}

constexpr double kLeastScale = 0.05;  // of the told size

}  // namespace

LandmarkPrior::LandmarkPrior(VecX mean_m, MatX P0_inverse, VecX aside_information)
    : mean(std::move(mean_m)),
      information(std::move(P0_inverse)),
      aside(std::move(aside_information)),
      outline(VecX::Zero(mean.size())) {
    Vec3 middle = Vec3::Zero();
    double total = 0.0;
    for (Eigen::Index r = 0; r < mean.size(); r += 3) {
        const double weight = information.block<3, 3>(r, r).trace();
        middle += weight * mean.segment<3>(r);
        total += weight;
    }
    middle /= total;
    for (Eigen::Index r = 0; r < mean.size(); r += 3)
        if (information(r, r) > 0.0) outline.segment<3>(r) = mean.segment<3>(r) - middle;
    pull = information * outline;
    scale_information = std::max(outline.dot(pull), std::numeric_limits<double>::min());
}

double LandmarkPrior::scale(std::span<const Vec3> X) const noexcept {
    const Eigen::Map<const VecX> x(X.front().data(), mean.size());
    return std::max(1.0 + pull.dot(x - mean) / scale_information, kLeastScale);
}

MatX landmark_covariance(std::span<const Vec3> X0, std::span<const Vec3> sigma, double scale_sigma) {
    if (sigma.size() != X0.size())
        throw std::invalid_argument("sigma: got " + std::to_string(sigma.size()) + " entries for " +
                                    std::to_string(X0.size()) + " landmarks, expected one each");
    if (X0.empty()) throw std::invalid_argument("landmarks: got none, expected at least one");
    const Eigen::Index n = static_cast<Eigen::Index>(X0.size());
    const Vec3 centre = centroid(X0);
    VecX offset(3 * n);
    VecX deviation(3 * n);
    for (Eigen::Index j = 0; j < n; ++j) {
        offset.segment<3>(3 * j) = scale_sigma * (X0[static_cast<std::size_t>(j)] - centre);
        deviation.segment<3>(3 * j) = sigma[static_cast<std::size_t>(j)];
    }
    MatX P0 = offset * offset.transpose();
    P0.diagonal() += deviation.cwiseAbs2();
    return P0;
}

LandmarkPrior make_prior(std::span<const Vec3> X0, const MatX& covariance, int aside) {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(X0.size());
    if (n == 0) throw std::invalid_argument("landmarks: got none, expected at least one");
    if (covariance.rows() != n || covariance.cols() != n)
        throw std::invalid_argument("prior covariance: got " + std::to_string(covariance.rows()) + " x " +
                                    std::to_string(covariance.cols()) + ", expected " + std::to_string(n) + " x " +
                                    std::to_string(n));
    const VecX mean = Eigen::Map<const VecX>(X0.front().data(), n);
    if (!mean.allFinite() || !covariance.allFinite())
        throw std::invalid_argument("landmark prior: got NaN or infinite values, expected finite ones");
    const double largest = covariance.cwiseAbs().maxCoeff();
    if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > 1e-9 * largest)
        throw std::invalid_argument("prior covariance: got an asymmetric matrix, expected a symmetric one");

    const Eigen::Index m = n - 3 * aside;
    VecX set_aside = VecX::Zero(n);
    set_aside.tail(n - m) = covariance.diagonal().tail(n - m).cwiseInverse();
    const double floor = std::pow(kFixedSigma * std::max(extent(X0.first(static_cast<std::size_t>(m / 3))), 1e-9), 2);
    const MatX P0 = covariance.topLeftCorner(m, m);
    const Eigen::SelfAdjointEigenSolver<MatX> eigen(0.5 * (P0 + P0.transpose()));
    if (eigen.eigenvalues().minCoeff() < -1e-9 * largest)
        throw std::invalid_argument("prior covariance: got a negative eigenvalue, expected positive semidefinite");
    const VecX information = (eigen.eigenvalues().array().max(0.0) + floor).inverse().matrix();
    const MatX inverse = eigen.eigenvectors() * information.asDiagonal() * eigen.eigenvectors().transpose();
    MatX padded = MatX::Zero(n, n);
    padded.topLeftCorner(m, m) = 0.5 * (inverse + inverse.transpose());
    return {mean, padded, set_aside};
}

double aside_cost(const LandmarkPrior& prior, std::span<const Vec3> X) noexcept {
    const Eigen::Map<const VecX> x(X.front().data(), prior.mean.size());
    return x.cwiseAbs2().dot(prior.aside);
}

/// With u = x - mean, e = u - (s - 1) x0 and i = x0^T p: (s - 1)^2 i + e^T P0^-1 e / s^2.
double squared_distance(const LandmarkPrior& prior, std::span<const Vec3> X) noexcept {
    const Eigen::Map<const VecX> x(X.front().data(), prior.mean.size());
    const auto u = x - prior.mean;
    const double grown = prior.scale(X) - 1.0;
    const double own = grown * grown * prior.scale_information;
    double shape = own - 2.0 * grown * prior.pull.dot(u);
    for (Eigen::Index c = 0; c < x.size(); ++c) {
        const Eigen::Index below = x.size() - c - 1;
        const double off_diagonal = prior.information.col(c).tail(below).dot(u.tail(below));
        shape += u[c] * (prior.information(c, c) * u[c] + 2.0 * off_diagonal);
    }
    return own + shape / ((1.0 + grown) * (1.0 + grown));
}

}  // namespace fairlead::window
