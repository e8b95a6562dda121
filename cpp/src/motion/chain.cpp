// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/chain.hpp"

#include <Eigen/Cholesky>

namespace fairlead::motion {
namespace {

// What is known of a motion before anything was seen of it, one standard deviation.
constexpr double kPosition = 1e6;     // [m]
constexpr double kSpeed = 200.0;      // [m/s]
constexpr double kAcceleration = 50;  // [m/s^2]

}  // namespace

Chain::Chain(const window::Reference& reference, int axes) : axes_(axes), slice_(reference) {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(reference.X.size());
    for (MatX* matrix : {&H_XX, &yy_, &scratch_}) matrix->setZero(n, n);
    for (ModelByState* matrix : {&H_Xn, &yn_, &wide_}) matrix->setZero(n, states());
    for (VecX* vector : {&g_X, &eta_y_}) vector->setZero(n);
    rate_t_.setZero(n, 7);
    nn_.setZero(states(), states());
    eta_n_.setZero(states());
    restart();
}

void Chain::restart() noexcept {
    if (nn_.diagonal().minCoeff() > 0.0) {
        marginal(scratch_, g_X);
        yy_ = scratch_;
        eta_y_ = g_X;
    }
    yn_.setZero();
    eta_n_.setZero();
    nn_.setZero();
    nn_.diagonal().head(axes_).setConstant(1.0 / (kPosition * kPosition));
    nn_.diagonal().segment(axes_, axes_).setConstant(1.0 / (kSpeed * kSpeed));
    nn_.diagonal().tail(axes_).setConstant(1.0 / (kAcceleration * kAcceleration));
}

void Chain::clear() noexcept {
    yy_.setZero();
    yn_.setZero();
    nn_.setZero();
    eta_y_.setZero();
    eta_n_.setZero();
}

/// n = M m: what was a function of n becomes one of m.
void Chain::substitute(const StateSquare& M) noexcept {
    wide_.noalias() = yn_ * M;
    yn_ = wide_;
    nn_ = (M.transpose() * nn_ * M).eval();
    eta_n_ = (M.transpose() * eta_n_).eval();
}

/// White noise through L: Lambda -= Lambda L (I + L^T Lambda L)^-1 L^T Lambda, docs/motion.md eq. (8).
void Chain::diffuse(const StateSquare& L) noexcept {
    StateSquare V = nn_ * L;
    const StateSquare G = StateSquare::Identity(states(), states()) + L.transpose() * V;
    const Eigen::LLT<StateSquare> llt(G);
    const auto C = llt.matrixL();
    V = C.solve(V.transpose()).transpose();
    wide_.noalias() = yn_ * C.solve(L.transpose()).transpose();
    const State e = C.solve(L.transpose() * eta_n_);
    yy_.noalias() -= wide_ * wide_.transpose();
    yn_.noalias() -= wide_ * V.transpose();
    nn_.noalias() -= V * V.transpose();
    nn_ = (0.5 * (nn_ + nn_.transpose())).eval();
    eta_y_.noalias() -= wide_ * e;
    eta_n_.noalias() -= V * e;
}

void Chain::predict(double dt, double density) noexcept {
    substitute(transition(-dt, axes_));
    diffuse(noise_factor(dt, density, axes_));
}

void Chain::loosen(double dt, double density) noexcept { diffuse(noise_factor(dt, density, axes_)); }

void Chain::retrodict(double dt, double density) noexcept {
    diffuse(noise_factor(dt, density, axes_));
    substitute(transition(dt, axes_));
}

void Chain::set_model(std::span<const Vec3> X) noexcept {
    slice_.linearise(X);
    slice_.gauge_rate(rate_t_);
}

State Chain::expected_motion() const noexcept {
    const State rhs = eta_n_ - yn_.transpose() * slice_.u();
    return nn_.llt().solve(rhs);
}

State Chain::motion_gradient(const State& n) const noexcept { return yn_.transpose() * slice_.u() + nn_ * n - eta_n_; }

void Chain::linearise(const State& n) noexcept {
    g_X.noalias() = yy_ * slice_.u();
    g_X.noalias() += yn_ * n;
    g_X -= eta_y_;
    slice_.pull_back(g_X);
    H_Xn = yn_;
    slice_.pull_back(H_Xn);
    scratch_ = yy_;
    slice_.pull_back(scratch_, H_XX);
}

void Chain::absorb(const MatX& A, const Eigen::Ref<const ModelByState>& B, const StateSquare& C, const VecX& g_X_view,
                   const State& g_n_view, const State& n) noexcept {
    const Eigen::Index size = A.rows();
    for (Eigen::Index j = 0; j < size; j += 3) {
        const Mat33& G = slice_.lift(j);
        for (Eigen::Index i = 0; i < size; i += 3)
            scratch_.block<3, 3>(i, j) = slice_.lift(i) * A.block<3, 3>(i, j) * G.transpose();
        wide_.middleRows<3>(j) = G * B.middleRows<3>(j);
        eta_y_.segment<3>(j) -= G * g_X_view.segment<3>(j);
    }
    yy_ += scratch_;
    yn_ += wide_;
    nn_ += C;
    eta_y_.noalias() += scratch_ * slice_.u();
    eta_y_.noalias() += wide_ * n;
    eta_n_ += wide_.transpose() * slice_.u() + C * n - g_n_view;
}

void Chain::marginal(MatX& Lambda, VecX& eta) noexcept {
    const Eigen::LLT<StateSquare> llt(nn_);
    wide_ = yn_;
    llt.matrixU().solveInPlace<Eigen::OnTheRight>(wide_);
    Lambda = yy_;
    Lambda.noalias() -= wide_ * wide_.transpose();
    eta = eta_y_;
    eta.noalias() -= wide_ * llt.matrixL().solve(eta_n_);
}

}  // namespace fairlead::motion
