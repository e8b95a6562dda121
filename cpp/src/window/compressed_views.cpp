// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/compressed_views.hpp"

#include "fairlead/window/eliminate.hpp"

namespace fairlead::window {

CompressedViews::CompressedViews(const Reference& reference) : slice_(reference) {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(reference.X.size());
    for (MatX* matrix : {&Lambda_, &hessian_, &A_}) matrix->setZero(n, n);
    for (VecX* vector : {&eta_, &gradient_, &q_}) vector->setZero(n);
}

/// Of a range whose bias is unknown: the bias moves the landmark along the line of sight.
void CompressedViews::add_bias(const PointTerm& term, const StateByPoint& rows, const Vec3& gradient) noexcept {
    const int a = 3 * term.landmark;
    const int b = 3 * term.bias;
    const Vec3 M_along = term.M * term.along;
    const Vec3 across = slice_.lift(a) * M_along;
    A_.row(b).head<ViewState::kDim>() += term.along.transpose() * rows;
    q_[b] += term.along.dot(gradient);
    Lambda_.block<3, 1>(a, b) += across;
    Lambda_.block<1, 3>(b, a) += across.transpose();
    Lambda_(b, b) += term.along.dot(M_along);
}

void CompressedViews::add(const ViewBlock& view, std::span<const Vec3> X) noexcept {
    slice_.align(X);
    const VecX& u = slice_.u();
    const Mat33& G = slice_.lift(0);  // d E / d y = G (d E / d X)
    const StateVector y = view.L_inverse * view.g;
    q_.setZero();
    A_.setZero();
    for (const PointTerm& term : view.terms) {
        const int a = term.landmark;
        const StateByPoint rows = reduced_rows(view, term, X[static_cast<std::size_t>(a)]);
        A_.block<3, ViewState::kDim>(3 * a, 0).noalias() += G * rows;  // scratch: Y^T in the first columns
        const Vec3 gradient = term.v - rows * y;
        q_.segment<3>(3 * a) += G * gradient;
        Lambda_.block<3, 3>(3 * a, 3 * a) += G * term.M * G.transpose();
        if (term.bias >= 0) add_bias(term, rows, gradient);
    }
    // b'^T u_lin and A' u_lin, A' = G M G^T - Y'^T Y', before Lambda takes the view in.
    const auto Yt = A_.leftCols<ViewState::kDim>();
    const StateVector Yu = Yt.transpose() * u;
    double quadratic = -Yu.squaredNorm();
    const double linear = q_.dot(u);
    eta_ -= q_;
    eta_.noalias() -= Yt * Yu;
    for (const PointTerm& term : view.terms) {
        const int a = term.landmark;
        Vec3 moved = G.transpose() * u.segment<3>(3 * a);
        if (term.bias >= 0) moved += u[3 * term.bias] * term.along;
        const Vec3 M_moved = term.M * moved;
        eta_.segment<3>(3 * a) += G * M_moved;
        if (term.bias >= 0) eta_[3 * term.bias] += term.along.dot(M_moved);
        quadratic += moved.dot(M_moved);
    }
    for (Eigen::Index c = 0; c < ViewState::kDim; ++c) Lambda_.noalias() -= Yt.col(c) * Yt.col(c).transpose();
    constant_ += view.inlier_squares + view.range_squares - y.squaredNorm() - 2.0 * linear + quadratic;
    views_ += view.share;
    empty_ = false;
    inliers_ += view.inliers;
}

void CompressedViews::replace(const MatX& Lambda, const VecX& eta, double scale) noexcept {
    empty_ = false;
    Lambda_ = scale * Lambda;
    eta_ = scale * eta;
}

void CompressedViews::add(const MatX& Lambda, const VecX& eta, double scale) noexcept {
    empty_ = false;
    Lambda_ += scale * Lambda;
    eta_ += scale * eta;
}

double CompressedViews::value(std::span<const Vec3> X) noexcept {
    slice_.align(X);
    const VecX& u = slice_.u();
    q_.noalias() = Lambda_ * u;
    return constant_ + u.dot(q_) - 2.0 * eta_.dot(u);
}

void CompressedViews::linearise(std::span<const Vec3> X) noexcept {
    slice_.linearise(X);
    gradient_.noalias() = Lambda_ * slice_.u();
    gradient_ -= eta_;
    slice_.pull_back(gradient_);
    A_ = Lambda_;
    slice_.pull_back(A_, hessian_);
}

}  // namespace fairlead::window
