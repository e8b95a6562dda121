// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/compressed_views.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "fairlead/window/eliminate.hpp"

namespace fairlead::window {
namespace {

using Mat77 = Eigen::Matrix<double, 7, 7>;

double radius_of(std::span<const Vec3> X) {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : X) centre += x / static_cast<double>(X.size());
    double radius = 0.0;
    for (const Vec3& x : X) radius = std::max(radius, (x - centre).norm());
    return std::max(radius, 1e-12);
}

}  // namespace

CompressedViews::CompressedViews(std::span<const Vec3> X_ref)
    : X_ref_(X_ref.begin(), X_ref.end()), radius_(radius_of(X_ref)), y_(X_ref_) {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(X_ref.size());
    for (MatX* matrix : {&Lambda_, &hessian_, &A_}) matrix->setZero(n, n);
    for (VecX* vector : {&eta_, &gradient_, &u_, &q_}) vector->setZero(n);
    for (GaugeBasis* basis : {&N_, &N_ref_, &LambdaN_, &U_t_}) basis->setZero(n, 7);
    gauge_basis(X_ref_, radius_, N_ref_);
}

void CompressedViews::shape(std::span<const Vec3> X, const Similarity& S) noexcept {
    for (std::size_t j = 0; j < X.size(); ++j) {
        y_[j] = S.s * (S.R * X[j]) + S.t;
        u_.segment<3>(3 * static_cast<Eigen::Index>(j)) = y_[j] - X_ref_[j];
    }
}

void CompressedViews::add(const ViewBlock& view, std::span<const Vec3> X) noexcept {
    const Similarity S = align(X, X_ref_);
    shape(X, S);
    const Mat33 G = S.R / S.s;  // d E / d y = G (d E / d X)
    const StateVector y = view.L_inverse * view.g;
    const std::size_t n = view.terms.size();
    q_.setZero();
    A_.setZero();
    for (std::size_t i = 0; i < n; ++i) {
        const int a = view.measurements[i].landmark;
        const StateByPoint rows = reduced_rows(view, view.terms[i], X[static_cast<std::size_t>(a)]);
        A_.block<3, ViewState::kDim>(3 * a, 0).noalias() = G * rows;  // scratch: Y^T in the first columns
        q_.segment<3>(3 * a) = G * (view.terms[i].v - rows * y);
        Lambda_.block<3, 3>(3 * a, 3 * a) += G * view.terms[i].M * G.transpose();
    }
    // b'^T u_lin and A' u_lin, A' = G M G^T - Y'^T Y', before Lambda takes the view in.
    const auto Yt = A_.leftCols<ViewState::kDim>();
    const StateVector Yu = Yt.transpose() * u_;
    double quadratic = -Yu.squaredNorm();
    const double linear = q_.dot(u_);
    eta_ -= q_;
    eta_.noalias() -= Yt * Yu;
    for (std::size_t i = 0; i < n; ++i) {
        const int a = view.measurements[i].landmark;
        const Vec3 Mu = G * (view.terms[i].M * (G.transpose() * u_.segment<3>(3 * a)));
        eta_.segment<3>(3 * a) += Mu;
        quadratic += u_.segment<3>(3 * a).dot(Mu);
    }
    for (Eigen::Index c = 0; c < ViewState::kDim; ++c) Lambda_.noalias() -= Yt.col(c) * Yt.col(c).transpose();
    constant_ += view.weighted_squares - y.squaredNorm() - 2.0 * linear + quadratic;
    ++views_;
    weights_ += view.weights;
}

double CompressedViews::value(std::span<const Vec3> X) noexcept {
    shape(X, align(X, X_ref_));
    q_.noalias() = Lambda_ * u_;
    return constant_ + u_.dot(q_) - 2.0 * eta_.dot(u_);
}

void CompressedViews::linearise(std::span<const Vec3> X) noexcept {
    const Similarity S = align(X, X_ref_);
    shape(X, S);
    gauge_basis(y_, radius_, N_);
    // Oblique projector P = I - N U, U = (N_ref^T N)^-1 N_ref^T: shape changes stay on the slice.
    Mat77 gram;
    gram.noalias() = N_ref_.transpose() * N_;
    const Mat77 inverse = gram.partialPivLu().inverse();
    U_t_.noalias() = N_ref_ * inverse.transpose();
    for (Eigen::Index c = 0; c < 7; ++c) LambdaN_.col(c).noalias() = Lambda_ * N_.col(c);
    Mat77 half_NLN;
    half_NLN.noalias() = N_.transpose() * LambdaN_;
    half_NLN *= 0.5;
    q_.noalias() = Lambda_ * u_;
    q_ -= eta_;
    const Eigen::Matrix<double, 7, 1> Nq = N_.transpose() * q_;
    q_.noalias() -= U_t_ * Nq;
    LambdaN_.noalias() -= U_t_ * half_NLN;
    A_ = Lambda_;
    for (Eigen::Index c = 0; c < 7; ++c) {
        A_.noalias() -= U_t_.col(c) * LambdaN_.col(c).transpose();
        A_.noalias() -= LambdaN_.col(c) * U_t_.col(c).transpose();
    }
    const Mat33 sR = S.s * S.R;
    const Eigen::Index n = static_cast<Eigen::Index>(X.size());
    for (Eigen::Index j = 0; j < n; ++j) {
        gradient_.segment<3>(3 * j) = sR.transpose() * q_.segment<3>(3 * j);
        for (Eigen::Index i = 0; i < n; ++i)
            hessian_.block<3, 3>(3 * i, 3 * j) = sR.transpose() * A_.block<3, 3>(3 * i, 3 * j) * sR;
    }
}

}  // namespace fairlead::window
