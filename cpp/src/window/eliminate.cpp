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

Vec3 point_step(const PointTerm& term, const VecX& dX) noexcept {
    const Vec3 own = dX.segment<3>(3 * term.landmark);
    return term.bias < 0 ? own : Vec3(own + dX[3 * term.bias] * term.along);
}

StateVector back_substitute(const ViewBlock& view, std::span<const Vec3> X_target, const VecX& dX) noexcept {
    StateVector rhs = view.g;
    for (const PointTerm& term : view.terms) {
        const int j = term.landmark;
        const Vec3 f = term.M * point_step(term, dX);
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
        const Vec3 gradient = term.v - rows * y;
        g.segment<3>(3 * j) += gradient;
        if (term.bias < 0) continue;
        const int b = 3 * term.bias;
        const Vec3 M_along = term.M * term.along;
        Y_.add(b, term.along.transpose() * rows);
        S.block<1, 3>(b, 3 * j) += M_along.transpose();
        S(b, b) += term.along.dot(M_along);
        g[b] += term.along.dot(gradient);
    }
    Y_.take(kDim);
    if (Y_.room() < kDim) flush(S);
}

void Eliminator::flush(MatX& S) noexcept { Y_.subtract_from(S); }

}  // namespace fairlead::window
