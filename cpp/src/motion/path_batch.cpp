// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// All views of a flight on one path.
#include <Eigen/Cholesky>

#include "fairlead/motion/path.hpp"

namespace fairlead::motion {

bool Path::append(window::ViewBlock& view, const std::optional<Attitude>& attitude,
                  const window::Problem& problem) noexcept {
    chain_.set_model(problem.X);
    n_.setZero();
    tie(chain_, view.state.T_camera_target, problem.X, attitude, n_);
    Vec3 position;
    Mat33 covariance;
    if (!own_position(view, problem.noise_factor, position, covariance)) return false;
    interval_s_ = started_ ? 1e-9 * static_cast<double>(view.stamp_ns - stamp_ns_) : 0.0;
    if (interval_s_ > kMaxInterval) bank_.restart();
    stamp_ns_ = view.stamp_ns;
    started_ = true;
    attitude_ = attitude;
    density_ = bank_.density();
    if (interval_s_ > 0.0 || kept_ == 0) bank_.observe(interval_s_, position, covariance);
    keep(view, problem);
    return true;
}

void Path::smooth(const window::Problem& problem) noexcept {
    while (to_look_back_ > 1) look_back(--to_look_back_);
    anew_ = base_;
    anew_.set_model(problem.X);
    for (std::size_t i = 0; i < kept_; ++i) retrace(anew_, past(i), problem);
    std::swap(chain_, anew_);
    anew_ = base_;
    retraced_ = 0;
    to_look_back_ = kept_;
}

/// Of each view's motion, from the views after it: a chain against time.
std::vector<Path::Later> Path::later_knowledge(const window::Problem& problem) {
    std::vector<Later> later(kept_);
    anew_.clear();
    anew_.set_model(problem.X);
    State n = State::Zero(anew_.states());
    for (std::size_t i = kept_; i-- > 0;) {
        const Past& here = past(i);
        later[i].nn = anew_.motion_information();
        later[i].Xn = anew_.coupling();
        anew_.pull_back(later[i].Xn);
        tie(anew_, here.view.state.T_camera_target, problem.X, here.attitude, n);
        absorb(anew_, here.view, problem.X, problem.noise_factor, n);
        if (here.interval_s > kMaxInterval)
            anew_.clear();
        else if (here.interval_s > 0.0)
            anew_.retrodict(here.interval_s, here.density);
    }
    return later;
}

std::vector<Mat66> Path::covariances(const window::Problem& problem, const MatX& Sigma) {
    const std::vector<Later> later = later_knowledge(problem);
    std::vector<Mat66> covariances(kept_, Mat66::Constant(std::numeric_limits<double>::quiet_NaN()));
    MatX S = MatX::Zero(Sigma.rows(), Sigma.cols());  // of no use here
    VecX g = VecX::Zero(Sigma.rows());
    anew_ = base_;
    anew_.set_model(problem.X);
    for (std::size_t i = 0; i < kept_; ++i) {
        const Past& here = past(i);
        forward(anew_, here);
        const State n = anew_.expected_motion();
        anew_.linearise(n);
        tie(anew_, here.view.state.T_camera_target, problem.X, here.attitude, n);
        if (eliminate(anew_, here.view, problem.X, problem.noise_factor, n, &later[i], S, g))
            covariances[i] = covariance(here.view, problem, Sigma);
        absorb(anew_, here.view, problem.X, problem.noise_factor, n);
    }
    anew_ = base_;
    return covariances;
}

}  // namespace fairlead::motion
