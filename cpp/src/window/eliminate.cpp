// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/eliminate.hpp"

#include <cmath>

namespace fairlead::window {
namespace {

constexpr int kDim = ViewState::kDim;
constexpr int kViews = 16;  // per rank update

}  // namespace

/// Gauss' elimination of [H, I] by rows, each divided by the root of its pivot, leaves [L^T, L^-1].
bool factor_state(double damping, ViewBlock& view) noexcept {
    Eigen::Matrix<double, kDim, 2 * kDim, Eigen::RowMajor> rows;
    rows << view.H, StateMatrix::Identity();
    rows.diagonal() *= 1.0 + damping;
    for (int k = 0; k < kDim; ++k) {
        const double pivot = rows(k, k);
        if (!(pivot > 0.0)) return false;
        rows.row(k) *= 1.0 / std::sqrt(pivot);
        for (int i = k + 1; i < kDim; ++i) rows.row(i) -= rows(k, i) * rows.row(k);
    }
    view.L_inverse = rows.rightCols<kDim>();
    return view.L_inverse.allFinite();
}

StateByPoint reduced_rows(const ViewBlock& view, const PointTerm& term, const Vec3& X) noexcept {
    const Eigen::Matrix<double, kDim, 3> EL =
        view.L_inverse.leftCols<3>() + so3::times_hat(view.L_inverse.rightCols<3>(), X);
    return (EL * term.M).transpose();
}

StateVector back_substitute(const ViewBlock& view, std::span<const Vec3> X_target, const VecX& dX) noexcept {
    StateVector rhs = view.g;
    for (const PointTerm& term : view.terms) {
        const int j = term.landmark;
        const Vec3 f = term.M * dX.segment<3>(3 * j);
        rhs.head<3>() += f;
        rhs.tail<3>() += X_target[static_cast<std::size_t>(j)].cross(f);
    }
    return -(view.L_inverse.transpose() * (view.L_inverse * rhs));
}

Eliminator::Eliminator(int landmarks) : Y_(3 * landmarks, kDim * kViews) {}

void Eliminator::add(const ViewBlock& view, std::span<const Vec3> X_target, MatX& S, VecX& g) noexcept {
    const StateVector y = view.L_inverse * view.g;
    for (const PointTerm& term : view.terms) {
        const int j = term.landmark;
        const StateByPoint rows = reduced_rows(view, term, X_target[static_cast<std::size_t>(j)]);
        for (int r = 0; r < 3; ++r) Y_.add(3 * j + r, rows.row(r));
        S.block<3, 3>(3 * j, 3 * j) += term.M;
        g.segment<3>(3 * j) += term.v - rows * y;
    }
    Y_.take(kDim);
    if (Y_.room() < kDim) flush(S);
}

void Eliminator::flush(MatX& S) noexcept { Y_.subtract_from(S); }

}  // namespace fairlead::window
