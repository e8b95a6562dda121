// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/slice.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace fairlead::window {
namespace {

using Mat77 = Eigen::Matrix<double, 7, 7>;

Vec3 centroid(std::span<const Vec3> X) noexcept {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : X) centre += x / static_cast<double>(X.size());
    return centre;
}

double radius_of(std::span<const Vec3> X) noexcept {
    const Vec3 centre = centroid(X);
    double radius = 0.0;
    for (const Vec3& x : X) radius = std::max(radius, (x - centre).norm());
    return std::max(radius, 1e-12);
}

}  // namespace

Slice::Slice(const Reference& reference)
    : gauge_(reference.gauge),
      landmarks_(reference.X.size() - static_cast<std::size_t>(reference.aside)),
      X_ref_(reference.X.begin(), reference.X.end()),
      y_(X_ref_),
      radius_(radius_of(landmarks(X_ref_))) {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(X_ref_.size());
    u_.setZero(n);
    for (GaugeBasis* basis : {&N_, &N_ref_, &U_t_, &AN_}) basis->setZero(n, 7);
    gauge_basis(landmarks(X_ref_), radius_, N_ref_);
    if (gauge_ == Gauge::rigid) N_ref_.col(6).setZero();
}

Vec3 Slice::centre() const noexcept { return centroid(landmarks(y_)); }

void Slice::align(std::span<const Vec3> X) noexcept {
    S_ = window::align(landmarks(X), landmarks(X_ref_));
    if (gauge_ == Gauge::rigid) {
        S_.s = 1.0;
        S_.t = centroid(landmarks(X_ref_)) - S_.R * centroid(landmarks(X));
    }
    factor_ = S_.s * S_.R;
    lift_ = S_.R / S_.s;
    for (std::size_t j = 0; j < X.size(); ++j) {
        y_[j] = j < landmarks_ ? Vec3(S_.s * (S_.R * X[j]) + S_.t) : X[j];
        u_.segment<3>(3 * static_cast<Eigen::Index>(j)) = y_[j] - X_ref_[j];
    }
}

void Slice::linearise(std::span<const Vec3> X) noexcept {
    align(X);
    gauge_basis(landmarks(y_), radius_, N_);
    // P = I - N U, U = (N_ref^T N)^-1 N_ref^T: changes of y stay on the slice.
    Mat77 gram;
    gram.noalias() = N_ref_.transpose() * N_;
    if (gauge_ == Gauge::rigid) {
        N_.col(6).setZero();
        gram.col(6).setZero();
        gram(6, 6) = 1.0;
    }
    const Mat77 inverse = gram.partialPivLu().inverse();
    U_t_.noalias() = N_ref_ * inverse.transpose();
}

void Slice::pull_back(MatX& A, MatX& H) noexcept {
    for (Eigen::Index c = 0; c < 7; ++c) AN_.col(c).noalias() = A * N_.col(c);
    Mat77 half_NAN;
    half_NAN.noalias() = N_.transpose() * AN_;
    half_NAN *= 0.5;
    AN_.noalias() -= U_t_ * half_NAN;
    for (Eigen::Index c = 0; c < 7; ++c) {
        A.noalias() -= U_t_.col(c) * AN_.col(c).transpose();
        A.noalias() -= AN_.col(c) * U_t_.col(c).transpose();
    }
    for (Eigen::Index j = 0; j < A.rows(); j += 3) {
        const Mat33& right = factor(j);
        for (Eigen::Index i = 0; i < A.rows(); i += 3)
            H.block<3, 3>(i, j) = factor(i).transpose() * A.block<3, 3>(i, j) * right;
    }
}

void Slice::gauge_rate(GaugeBasis& rate_t) const noexcept {
    for (Eigen::Index j = 0; j < u_.size(); j += 3)
        rate_t.middleRows<3>(j) = -(factor(j).transpose() * U_t_.middleRows<3>(j));
}

}  // namespace fairlead::window
