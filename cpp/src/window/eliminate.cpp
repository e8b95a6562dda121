// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/eliminate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace fairlead::window {
namespace {

constexpr int kDim = ViewState::kDim;
// Views per rank update: as many as keep the product's packed operands within Eigen's stack limit, so that nothing is
// allocated.
int chunk_views(int landmarks) { return std::clamp(10000 / (3 * landmarks * kDim), 1, 16); }

}  // namespace

bool factor_state(double damping, ViewBlock& view) noexcept {
    StateMatrix H = view.H;
    H.diagonal() *= 1.0 + damping;
    const Eigen::LLT<StateMatrix> llt(H);
    if (llt.info() != Eigen::Success) return false;
    view.L_inverse.setIdentity();
    llt.matrixL().solveInPlace(view.L_inverse);
    return view.L_inverse.allFinite();
}

StateByPoint reduced_rows(const ViewBlock& view, const PointTerm& term, const Vec3& X) noexcept {
    const Eigen::Matrix<double, kDim, 3> EL =
        view.L_inverse.leftCols<3>() + view.L_inverse.rightCols<3>() * so3::hat(X);
    return term.M * EL.transpose();
}

StateVector back_substitute(const ViewBlock& view, std::span<const Vec3> X_target, const VecX& dX) noexcept {
    StateVector rhs = view.g;
    for (std::size_t i = 0; i < view.terms.size(); ++i) {
        const int j = view.measurements[i].landmark;
        const Vec3 f = view.terms[i].M * dX.segment<3>(3 * j);
        rhs.head<3>() += f;
        rhs.tail<3>() += X_target[static_cast<std::size_t>(j)].cross(f);
    }
    return -(view.L_inverse.transpose() * (view.L_inverse * rhs));
}

Eliminator::Eliminator(int landmarks) : Yt_(3 * landmarks, kDim * chunk_views(landmarks)) { Yt_.setZero(); }

void Eliminator::add(const ViewBlock& view, std::span<const Vec3> X_target, MatX& S, VecX& g) noexcept {
    const StateVector y = view.L_inverse * view.g;
    for (std::size_t i = 0; i < view.terms.size(); ++i) {
        const int j = view.measurements[i].landmark;
        const PointTerm& term = view.terms[i];
        const StateByPoint rows = reduced_rows(view, term, X_target[static_cast<std::size_t>(j)]);
        Yt_.block<3, kDim>(3 * j, filled_) = rows;
        S.block<3, 3>(3 * j, 3 * j) += term.M;
        g.segment<3>(3 * j) += term.v - rows * y;
    }
    filled_ += kDim;
    if (filled_ == Yt_.cols()) flush(S);
}

void Eliminator::flush(MatX& S) noexcept {
    if (filled_ == 0) return;
    S.selfadjointView<Eigen::Lower>().rankUpdate(Yt_.leftCols(filled_), -1.0);
    Yt_.leftCols(filled_).setZero();
    filled_ = 0;
}

}  // namespace fairlead::window
