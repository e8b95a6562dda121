// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// The window behind the newest view: what is linearised anew, what is compressed, what is reported.
#include <algorithm>
#include <cmath>

#include "fairlead/tracker/structure.hpp"
#include "fairlead/window/gauge_curvature.hpp"
#include "fairlead/window/keyframes.hpp"

namespace fairlead {
namespace {

using window::ViewBlock;

constexpr int kRelinearisations = 10;
constexpr double kNews = 0.1;     // [sigma] error beyond which outliers are judged anew as well
constexpr double kWidest = 16.0;  // how much wider the loss then begins

Eigen::Map<const VecX> stacked(const std::vector<Vec3>& X) {
    return {X.front().data(), 3 * static_cast<Eigen::Index>(X.size())};
}

}  // namespace

void Structure::absorb_newest() noexcept {
    window::assemble(data_, problem_.X, workspace_);
    data_.g = workspace_.g;
    data_.X = problem_.X;
    workspace_.eliminator.add(problem_.views.back(), problem_.X, data_.H, data_.g);
    workspace_.eliminator.flush(data_.H);
}

/// Estimated error [sigma] of treating the window as a quadratic: relative change of the model times its whitened size.
double Structure::nonlinearity() noexcept {
    double largest = 0.0;
    for (std::size_t j = 0; j < landmarks_; ++j) largest = std::max(largest, (problem_.X[j] - X_window_[j]).norm());
    shift_ = stacked(problem_.X) - stacked(X_window_);
    workspace_.step.noalias() = workspace_.S.selfadjointView<Eigen::Lower>() * shift_;
    return largest / radius_ * std::sqrt(std::max(0.0, shift_.dot(workspace_.step)));
}

/// The window solved anew, with a loss that narrows from `widest` times its width.
bool Structure::solve_window(double widest) noexcept {
    const window::LmOptions options{.max_iterations = kRelinearisations, .initial_damping = 1e-6, .tolerance = 1e-6};
    const double width = problem_.loss.threshold;
    bool ok = true;
    for (double mu = widest; ok && mu >= 1.0; mu *= 0.25) {
        problem_.loss.threshold = mu * width;
        ok = window::levenberg_marquardt(problem_, options, workspace_).ok;
    }
    problem_.loss.threshold = width;
    return ok;
}

/// The poses of the window follow the model, each by a step of its own, and all is linearised there; the model's step
/// was taken when the newest view was joined.
bool Structure::follow_model() noexcept {
    for (ViewBlock& view : problem_.views) {
        if (!window::linearise(problem_.camera, problem_.X, problem_.told_loss(), problem_.noise_factor, view) ||
            !window::factor_state(0.0, view))
            return false;
        view.state.T_camera_target =
            perturb(view.state.T_camera_target, -(view.L_inverse.transpose() * (view.L_inverse * view.g)));
    }
    return window::linearise(problem_);
}

/// All views of the window again: solved if there was much news of the model, else just moved along with it.
bool Structure::relinearise(double error) noexcept {
    if (path_) {
        path_->marginal(workspace_.product, workspace_.D);
        problem_.path->replace(workspace_.product, workspace_.D, problem_.noise_factor);
    }
    const bool few = problem_.views.size() <= kFewViews;
    if (!(few || stale_ || error > kNews ? solve_window(kWidest) : follow_model())) return false;
    if (!window::assemble_data(problem_, 0.0, workspace_)) return false;
    data_.H = workspace_.S;
    data_.g = workspace_.g;
    if (problem_.path) {  // joined view by view, not as part of the window
        data_.H -= problem_.path->hessian();
        data_.g -= problem_.path->gradient();
    }
    data_.X = X_window_ = problem_.X;
    window::scale_and_add_prior(problem_, problem_.X, workspace_);
    return workspace_.cholesky.factor(workspace_.S);
}

MatX Structure::covariance() const {
    MatX Sigma = covariance_linear();
    if (fused_ > 0) window::add_gauge_curvature(landmarks(), Sigma);
    return Sigma;
}

/// The factors of the prior, ever more rarely: the data say the less news of them the more there are.
void Structure::judge_prior() noexcept {
    if (++fused_ < next_judgement_) return;
    next_judgement_ = fused_ + 1 + fused_ / 4;
    window::update_prior_factors(problem_, data_, workspace_);
}

void Structure::publish() noexcept {
    determined_ = window::structure_covariance(problem_, workspace_, Sigma_);
    for (std::size_t j = 0; j < blocks_.size(); ++j) {
        const Eigen::Index row = 3 * static_cast<Eigen::Index>(j);
        blocks_[j] = Sigma_.block<3, 3>(row, row);
    }
}

/// The most redundant view, fitted to the present model, joins the compressed ones; the quadratic already holds it.
void Structure::spare_one() noexcept {
    const auto index = static_cast<std::size_t>(window::most_redundant(problem_.views, descriptors_));
    ViewBlock& view = problem_.views[index];
    bool usable = true;
    for (int iteration = 0; usable && iteration < 3; ++iteration) {
        usable = window::linearise(problem_.camera, problem_.X, problem_.told_loss(), problem_.noise_factor, view) &&
                 window::factor_state(0.0, view);
        if (usable && iteration < 2)
            view.state.T_camera_target =
                perturb(view.state.T_camera_target, -(view.L_inverse.transpose() * (view.L_inverse * view.g)));
    }
    if (usable) problem_.compressed[view.ranges.empty() ? 0 : 1].add(view, problem_.X);
    retire(index);
}

void Structure::retire(std::size_t index) noexcept {
    std::swap(problem_.views[index], problem_.views.back());
    pool_.push_back(std::move(problem_.views.back()));
    problem_.views.pop_back();
}

}  // namespace fairlead
