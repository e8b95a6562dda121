// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/path.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace fairlead::motion {

Path::Path(Kind kind, double density, const window::Reference& reference, std::size_t kept)
    : kind_(kind),
      axes_(axes_of(kind)),
      chain_(reference, axes_),
      base_(chain_),
      anew_(chain_),
      past_(kept),
      bank_(density, axes_),
      tie_(static_cast<int>(reference.X.size())) {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(reference.X.size());
    const Eigen::Index joint = 6 + chain_.states();
    for (ModelByJoint* matrix : {&rows_t_, &Y_t_, &SigmaY_t_}) matrix->setZero(n, joint);
    A_.setZero(n, n);
    b_.setZero(n);
    n_.setZero(chain_.states());
    y_.setZero(joint);
    L_inverse_.setIdentity(joint, joint);
    loosened_ = density_ = density;
    for (Past& past : past_) {
        past.view = window::ViewBlock(static_cast<int>(reference.X.size()));
        past.later_information.setZero(chain_.states(), chain_.states());
        past.later.setZero(chain_.states());
    }
}

void Path::restart() noexcept {
    chain_.restart();
    base_ = anew_ = chain_;
    kept_ = retraced_ = to_look_back_ = 0;
    bank_.restart();
    loosened_ = density_ = bank_.density();
    started_ = false;
}

void Path::advance(std::int64_t stamp_ns, std::span<const Vec3> X, const std::optional<Attitude>& attitude) noexcept {
    interval_s_ = started_ ? 1e-9 * static_cast<double>(stamp_ns - stamp_ns_) : 0.0;
    if (interval_s_ > kMaxInterval) {
        restart();
        interval_s_ = 0.0;
    }
    density_ = bank_.density();
    if (interval_s_ > 0.0) chain_.predict(interval_s_, density_);
    catch_up();
    stamp_ns_ = stamp_ns;
    started_ = true;
    attitude_ = attitude;
    chain_.set_model(X);
    n_ = chain_.expected_motion();
}

void Path::tie(const Chain& chain, const SE3& T, std::span<const Vec3> X, const std::optional<Attitude>& attitude,
               const State& n) noexcept {
    tied_ = measure(kind_, T, X, chain.slice(), chain.gauge_rate_t(), attitude, tie_);
    residual_.setZero();
    if (tied_) residual_.head(axes_) = tie_.value.head(axes_) - n.head(axes_);
}

void Path::motion_system(const Chain& chain, const window::ViewBlock& view, double noise_factor, const State& n,
                         JointSquare& H, Joint& h) const noexcept {
    const Eigen::Index states = chain.states();
    H.setZero(6 + states, 6 + states);
    h.resize(6 + states);
    H.topLeftCorner<6, 6>() = view.H / noise_factor;
    H.bottomRightCorner(states, states) = chain.motion_information();
    h << view.g / noise_factor, chain.motion_gradient(n);
    if (!tied_) return;
    const Mat33& W = tie_.information;
    const Eigen::Matrix<double, 3, 6> WJ = W * tie_.J_pose;
    H.topLeftCorner<6, 6>() += tie_.J_pose.transpose() * WJ;
    H.block(0, 6, 6, axes_) -= WJ.topRows(axes_).transpose();
    H.block(6, 0, axes_, 6) -= WJ.topRows(axes_);
    H.block(6, 6, axes_, axes_) += W.topLeftCorner(axes_, axes_);
    h.head<6>() += WJ.transpose() * residual_;
    h.segment(6, axes_) -= (W * residual_).head(axes_);
}

/// The view's own terms and its tie to the path: into S and g what concerns the structure, into rows_t_ its coupling to
/// the pose.
void Path::add_view(const window::ViewBlock& view, std::span<const Vec3> X, double noise_factor, MatX& S,
                    VecX& g) noexcept {
    const double scale = 1.0 / noise_factor;
    for (const window::PointTerm& term : view.terms) {
        const Eigen::Index row = 3 * term.landmark;
        const Mat33 M = scale * term.M;
        Eigen::Matrix<double, 3, 6> rows;
        rows << M, -M * so3::hat(X[static_cast<std::size_t>(term.landmark)]);
        rows_t_.block<3, 6>(row, 0) += rows;
        S.block<3, 3>(row, row) += M;
        g.segment<3>(row) += scale * term.v;
        if (term.bias < 0) continue;
        const Eigen::Index b = 3 * term.bias;
        const Vec3 M_along = M * term.along;
        rows_t_.block<1, 6>(b, 0) += term.along.transpose() * rows;
        S.block<3, 1>(row, b) += M_along;
        S.block<1, 3>(b, row) += M_along.transpose();
        S(b, b) += term.along.dot(M_along);
        g[b] += scale * term.along.dot(term.v);
    }
    if (!tied_) return;
    const Eigen::Matrix<double, 3, 6> WJ = tie_.information * tie_.J_pose;
    rows_t_.leftCols<6>().noalias() += tie_.J_X_t * WJ;
    Y_t_.leftCols<3>().noalias() = tie_.J_X_t * tie_.information;  // scratch
    S.noalias() += Y_t_.leftCols<3>() * tie_.J_X_t.transpose();
    g.noalias() += Y_t_.leftCols<3>() * residual_;
}

bool Path::join(const window::ViewBlock& view, std::span<const Vec3> X, double noise_factor, MatX& S,
                VecX& g) noexcept {
    chain_.set_model(X);
    chain_.linearise(n_);
    tie(chain_, view.state.T_camera_target, X, attitude_, n_);
    S += chain_.H_XX;
    g += chain_.g_X;
    return eliminate(chain_, view, X, noise_factor, n_, nullptr, S, g);
}

/// Pose and motion of a view out of the system; the chain linearised at n, the tie measured.
bool Path::eliminate(const Chain& chain, const window::ViewBlock& view, std::span<const Vec3> X, double noise_factor,
                     const State& n, const Later* later, MatX& S, VecX& g) noexcept {
    JointSquare H;
    Joint h;
    motion_system(chain, view, noise_factor, n, H, h);
    rows_t_.setZero();
    rows_t_.rightCols(chain.states()) = chain.H_Xn;
    if (later != nullptr) {
        H.bottomRightCorner(chain.states(), chain.states()) += later->nn;
        rows_t_.rightCols(chain.states()) += later->Xn;
    }
    if (tied_) rows_t_.middleCols(6, axes_).noalias() -= tie_.J_X_t * tie_.information.leftCols(axes_);
    add_view(view, X, noise_factor, S, g);

    const Eigen::LLT<JointSquare> llt(H);
    if (llt.info() != Eigen::Success) return false;
    L_inverse_.setIdentity();
    llt.matrixL().solveInPlace(L_inverse_);
    y_ = L_inverse_ * h;
    Y_t_.noalias() = rows_t_ * L_inverse_.transpose();
    S.noalias() -= Y_t_ * Y_t_.transpose();
    g.noalias() -= Y_t_ * y_;
    return L_inverse_.allFinite();
}

Vec6 Path::step(const VecX& dX) noexcept {
    const Joint d = -(L_inverse_.transpose() * (y_ + Y_t_.transpose() * dX));
    n_ += d.tail(chain_.states());
    return d.head<6>();
}

Mat66 Path::covariance(const window::ViewBlock& view, const window::Problem& problem, const MatX& Sigma) noexcept {
    SigmaY_t_.noalias() = Sigma * Y_t_;
    JointSquare inner = Y_t_.transpose() * SigmaY_t_;
    inner.diagonal().array() += 1.0;
    const JointSquare joint = L_inverse_.transpose() * inner * L_inverse_;
    // This one view errs as told, however alike its neighbours: docs/motion.md eq. (13).
    const Mat66 alone = (L_inverse_.transpose() * L_inverse_).topLeftCorner<6, 6>();
    const double excess = (problem.pose_factor * view.share / problem.noise_factor - 1.0) / problem.noise_factor;
    const Mat66 covariance = joint.topLeftCorner<6, 6>() + excess * alone * view.H * alone;
    return 0.5 * (covariance + covariance.transpose());
}

/// The view with its pose eliminated into the chain, at the tie as last measured.
void Path::absorb(Chain& chain, const window::ViewBlock& view, std::span<const Vec3> X, double noise_factor,
                  const State& n) noexcept {
    const Mat33 W = tied_ ? tie_.information : Mat33::Zero();  // without a tie the view still knows of the shape
    const Eigen::Matrix<double, 3, 6> WJ = W * tie_.J_pose;
    const Mat66 H = view.H / noise_factor + tie_.J_pose.transpose() * WJ;
    const Vec6 h = view.g / noise_factor + WJ.transpose() * residual_;
    const Eigen::LLT<Mat66> llt(H);
    if (llt.info() != Eigen::Success) return;
    A_.setZero();
    b_.setZero();
    rows_t_.setZero();
    add_view(view, X, noise_factor, A_, b_);
    Mat66 L_inverse = Mat66::Identity();
    llt.matrixL().solveInPlace(L_inverse);
    Y_t_.leftCols<6>().noalias() = rows_t_.leftCols<6>() * L_inverse.transpose();
    const Vec6 y = L_inverse * h;
    A_.noalias() -= Y_t_.leftCols<6>() * Y_t_.leftCols<6>().transpose();
    b_.noalias() -= Y_t_.leftCols<6>() * y;
    // Of the motion only the position is coupled, by -W.
    const Eigen::Matrix<double, 6, 3> Z = -L_inverse * WJ.transpose();
    StateSquare C = StateSquare::Zero(chain.states(), chain.states());
    State c = State::Zero(chain.states());
    C.topLeftCorner(axes_, axes_) = (W - Z.transpose() * Z).topLeftCorner(axes_, axes_);
    c.head(axes_) = (-(W * residual_) - Z.transpose() * y).head(axes_);
    SigmaY_t_.setZero();
    SigmaY_t_.leftCols(axes_).noalias() -= tie_.J_X_t * W.leftCols(axes_);
    SigmaY_t_.leftCols(axes_).noalias() -= Y_t_.leftCols<6>() * Z.leftCols(axes_);
    chain.absorb(A_, SigmaY_t_.leftCols(chain.states()), C, b_, c, n);
}

double Path::range_rate() const noexcept {
    if (kind_ == Kind::range) return n_[1] / chain_.slice().similarity().s;
    Vec3 away = n_.head<3>();
    if (kind_ == Kind::target) away -= chain_.slice().centre();
    return away.normalized().dot(n_.segment<3>(3)) / chain_.slice().similarity().s;
}

bool Path::own_position(const window::ViewBlock& view, double noise_factor, Vec3& position,
                        Mat33& covariance) const noexcept {
    const Eigen::LLT<Mat66> llt(view.H);
    if (!tied_ || llt.info() != Eigen::Success) return false;
    position = tie_.value - tie_.J_pose * llt.solve(view.g);
    const Eigen::Matrix<double, 6, 3> spread = llt.solve(tie_.J_pose.transpose());
    covariance = noise_factor * tie_.J_pose * spread + tie_.covariance;
    return true;
}

window::ViewBlock Path::settle(window::ViewBlock&& view, const window::Problem& problem) noexcept {
    Vec3 position;
    Mat33 covariance;
    if (own_position(view, problem.noise_factor, position, covariance))
        bank_.observe(interval_s_, position, covariance);
    absorb(chain_, view, problem.X, problem.noise_factor, n_);
    keep(view, problem);
    go_through_some(problem);
    return std::move(view);
}

}  // namespace fairlead::motion
