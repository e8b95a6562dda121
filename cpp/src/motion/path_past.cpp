// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// The views that a path has behind it, gone through again.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "fairlead/motion/path.hpp"

namespace fairlead::motion {
namespace {

constexpr std::size_t kLookedBack = 32;  // views in an update, backwards
constexpr std::size_t kRetraced = 6;     // views in an update, forwards
constexpr int kPoseIterations = 2;
constexpr double kRise = 3.0;     // times the density that make a contradiction
constexpr double kTooLate = 0.5;  // [s] by which it is noticed

}  // namespace

/// The chain an interval later; after a long one the motion begins anew.
void Path::forward(Chain& chain, const Past& past) noexcept {
    if (past.interval_s > kMaxInterval)
        chain.restart();
    else if (past.interval_s > 0.0)
        chain.predict(past.interval_s, past.density);
}

/// One view of the past into a chain: its pose and motion fitted to the model as it is now and to the views before and
/// after it, then absorbed. A view linearised at its own noise, or at what only earlier views say, would claim to know
/// the model.
void Path::retrace(Chain& chain, Past& past, const window::Problem& problem) noexcept {
    forward(chain, past);
    State n = chain.expected_motion();
    SE3& T = past.view.state.T_camera_target;
    for (int iteration = 0;; ++iteration) {
        if (!window::linearise(problem.camera, problem.X, problem.told_loss(), problem.noise_factor, past.view)) return;
        tie(chain, T, problem.X, past.attitude, n);
        if (iteration == kPoseIterations) break;
        JointSquare H;
        Joint h;
        motion_system(chain, past.view, problem.noise_factor, n, H, h);
        H.bottomRightCorner(chain.states(), chain.states()) += past.later_information;
        h.tail(chain.states()) += past.later_information * n - past.later;
        const Eigen::LLT<JointSquare> llt(H);
        const Joint step = -llt.solve(h);
        if (llt.info() != Eigen::Success || !step.allFinite()) return;
        T = perturb(T, Vec6(step.head<6>()));
        n += step.tail(chain.states());
    }
    Mat33 covariance;
    past.information.setZero();
    if (own_position(past.view, problem.noise_factor, past.position, covariance))
        past.information.topLeftCorner(axes_, axes_) =
            StateSquare(covariance.topLeftCorner(axes_, axes_)).llt().solve(StateSquare::Identity(axes_, axes_));
    absorb(chain, past.view, problem.X, problem.noise_factor, n);
}

/// A rise of the density is noticed late: what was taken for smooth in the meantime was not, docs/motion.md section 4.
void Path::catch_up() noexcept {
    if (density_ <= kRise * loosened_) {
        loosened_ += (density_ - loosened_) * (1.0 - std::exp(-interval_s_ / kTooLate));
        return;
    }
    chain_.loosen(kTooLate, density_);
    loosened_ = density_;
    double age = interval_s_;
    for (std::size_t i = kept_; i-- > 0 && age < kTooLate; age += past(i).interval_s)
        past(i).density = std::max(past(i).density, density_);
}

/// What view i and those after it say of the motion at view i - 1: an information filter against time.
void Path::look_back(std::size_t i) noexcept {
    const Past& here = past(i);
    Past& before = past(i - 1);
    StateSquare J = here.later_information;
    State j = here.later;
    J.topLeftCorner(axes_, axes_) += here.information.topLeftCorner(axes_, axes_);
    j.head(axes_) += (here.information * here.position).head(axes_);
    before.later_information = J;
    before.later = j;
    if (here.interval_s > kMaxInterval) {
        before.later_information.setZero();
        before.later.setZero();
    } else if (here.interval_s > 0.0) {
        const StateSquare L = noise_factor(here.interval_s, here.density, axes_);
        const StateSquare Phi = transition(here.interval_s, axes_);
        const StateSquare JL = J * L;
        const Eigen::LLT<StateSquare> llt(StateSquare::Identity(3 * axes_, 3 * axes_) + L.transpose() * JL);
        J -= JL * llt.solve(JL.transpose());
        j -= JL * llt.solve(L.transpose() * j);
        before.later_information = Phi.transpose() * J * Phi;
        before.later = Phi.transpose() * j;
    }
}

/// Forwards with the model as it is now; then back, so that the next time forwards every view knows of those after it.
void Path::go_through_some(const window::Problem& problem) noexcept {
    for (std::size_t i = 0; i < kLookedBack && to_look_back_ > 1; ++i) look_back(--to_look_back_);
    if (to_look_back_ > 1) return;
    anew_.set_model(problem.X);
    for (std::size_t i = 0; i < kRetraced && retraced_ < kept_; ++i) retrace(anew_, past(retraced_++), problem);
    if (retraced_ < kept_) return;
    std::swap(chain_, anew_);
    anew_ = base_;
    retraced_ = 0;
    to_look_back_ = kept_;
}

/// Puts the view in the place of a free block of the past; the oldest makes room.
void Path::keep(window::ViewBlock& view, const window::Problem& problem) noexcept {
    if (kept_ == past_.size()) {
        base_.set_model(problem.X);
        retrace(base_, past(0), problem);
        first_ = (first_ + 1) % past_.size();
        --kept_;
        to_look_back_ -= to_look_back_ > 0 ? 1 : 0;
        if (retraced_ > 0)
            --retraced_;
        else
            anew_ = base_;
    }
    Past& slot = past(kept_++);
    std::swap(slot.view, view);
    slot.interval_s = interval_s_;
    slot.density = density_;
    slot.attitude = attitude_;
    slot.later_information.setZero();
    slot.later.setZero();
}

}  // namespace fairlead::motion
