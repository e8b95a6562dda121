// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/structure.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fairlead/window/gauge_curvature.hpp"
#include "fairlead/window/keyframes.hpp"

namespace fairlead {
namespace {

using window::ViewBlock;

constexpr int kJoinIterations = 8;
constexpr double kJoinStep = 0.01;      // squared step [sigma^2] below which the newest view is settled
constexpr double kNonlinearity = 0.01;  // [sigma] error of the quadratic before its views are relinearised
constexpr double kNews = 0.1;           // [sigma] error beyond which outliers are judged anew as well
constexpr double kWidest = 16.0;        // how much wider the loss then begins
constexpr std::size_t kFewViews = 16;   // windows this small are always solved anew
constexpr int kRelinearisations = 10;

Eigen::Map<const VecX> stacked(const std::vector<Vec3>& X) {
    return {X.front().data(), 3 * static_cast<Eigen::Index>(X.size())};
}

}  // namespace

Structure::Structure(const Camera& camera, std::span<const Vec3> X0, const MatX& P0, int max_views,
                     double loss_threshold)
    : workspace_(static_cast<int>(X0.size())), max_views_(static_cast<std::size_t>(max_views)) {
    validate(camera);
    problem_.camera = camera;
    problem_.prior = window::make_prior(X0, P0);
    problem_.compressed.emplace(X0);
    problem_.X.assign(X0.begin(), X0.end());
    problem_.loss.threshold = loss_threshold;
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(X0.size());
    H_data_.setZero(n, n);
    g_data_.setZero(n);
    shift_.setZero(n);
    X_data_ = X_window_ = problem_.X;
    Yt_.setZero(n, window::ViewState::kDim);
    SigmaYt_ = Yt_;
    Sigma_ = P0;
    blocks_.resize(X0.size());
    squares_.reserve(X0.size());
    for (std::size_t j = 0; j < X0.size(); ++j) {
        const Eigen::Index row = 3 * static_cast<Eigen::Index>(j);
        blocks_[j] = P0.block<3, 3>(row, row);
        radius_ = std::max(j == 0 ? 0.0 : radius_, (X0[j] - X0[0]).norm());
    }
    const std::size_t capacity = max_views_ + 1;
    problem_.views.reserve(capacity);
    workspace_.dT.reserve(capacity);
    workspace_.T_trial.reserve(capacity);
    descriptors_.resize(capacity);
    for (std::size_t k = 0; k < capacity; ++k) pool_.emplace_back(static_cast<int>(X0.size()));
    log_det_ = Eigen::LLT<MatX>(problem_.prior->information).matrixLLT().diagonal().array().log().sum();
}

/// The joint system of newest view and model: everything older is the quadratic. mu widens the loss.
bool Structure::newest_system(double mu) noexcept {
    ViewBlock& view = problem_.views.back();
    const Loss loss{mu * problem_.told_loss().threshold};
    if (!window::linearise(problem_.camera, problem_.X, loss, view) || !window::factor_state(0.0, view)) return false;
    shift_ = stacked(problem_.X) - stacked(X_data_);
    workspace_.S = H_data_;
    workspace_.g = g_data_;
    workspace_.g.noalias() += H_data_.selfadjointView<Eigen::Lower>() * shift_;
    workspace_.eliminator.add(view, problem_.X, workspace_.S, workspace_.g);
    workspace_.eliminator.flush(workspace_.S);
    window::scale_and_add_prior(problem_, problem_.X, workspace_);
    workspace_.llt.compute(workspace_.S);
    return workspace_.llt.info() == Eigen::Success;
}

/// Gauss-Newton on the newest pose and the model with the loss narrowed from what the start needs to its own width
/// (graduated non-convexity).
bool Structure::join_newest() noexcept {
    ViewBlock& view = problem_.views.back();
    squares_.clear();
    for (const window::Measurement& m : view.measurements) {
        Vec2 z;
        if (!problem_.camera.project(view.state.T_camera_target * problem_.X[static_cast<std::size_t>(m.landmark)], z))
            return false;
        squares_.push_back((z - m.z).dot(m.information * (z - m.z)));
    }
    const double widest = *std::max_element(squares_.begin(), squares_.end());
    double mu = std::max(1.0, widest / problem_.told_loss().threshold);
    for (int iteration = 0; iteration < kJoinIterations; ++iteration) {
        if (!newest_system(mu)) return false;
        workspace_.dX = -workspace_.g;
        workspace_.llt.solveInPlace(workspace_.dX);
        const double states = (view.L_inverse * view.g).squaredNorm() / problem_.noise_factor;
        if (mu == 1.0 && states - workspace_.g.dot(workspace_.dX) < kJoinStep) return true;
        const window::StateVector dT = window::back_substitute(view, problem_.X, workspace_.dX);
        if (!workspace_.dX.allFinite() || !dT.allFinite()) return false;
        view.state.T_camera_target = perturb(view.state.T_camera_target, dT);
        for (std::size_t j = 0; j < problem_.X.size(); ++j)
            problem_.X[j] += workspace_.dX.segment<3>(3 * static_cast<Eigen::Index>(j));
        mu = std::max(1.0, 0.25 * mu);
    }
    return newest_system(1.0);
}

void Structure::absorb_newest() noexcept {
    shift_ = stacked(problem_.X) - stacked(X_data_);
    g_data_.noalias() += H_data_.selfadjointView<Eigen::Lower>() * shift_;
    X_data_ = problem_.X;
    workspace_.eliminator.add(problem_.views.back(), problem_.X, H_data_, g_data_);
    workspace_.eliminator.flush(H_data_);
}

/// Estimated error [sigma] of treating the window as a quadratic: relative change of the model times its whitened size.
double Structure::nonlinearity() noexcept {
    double largest = 0.0;
    for (std::size_t j = 0; j < problem_.X.size(); ++j)
        largest = std::max(largest, (problem_.X[j] - X_window_[j]).norm());
    shift_ = stacked(problem_.X) - stacked(X_window_);
    workspace_.step.noalias() = workspace_.S.selfadjointView<Eigen::Lower>() * shift_;
    return largest / radius_ * std::sqrt(std::max(0.0, shift_.dot(workspace_.step)));
}

/// All views of the window again; with a loss that narrows from `widest` times its width if there was much news.
bool Structure::relinearise(double widest) noexcept {
    const window::LmOptions options{.max_iterations = kRelinearisations, .initial_damping = 1e-6, .tolerance = 1e-6};
    const double width = problem_.loss.threshold;
    bool ok = true;
    for (double mu = widest; ok && mu >= 1.0; mu *= 0.25) {
        problem_.loss.threshold = mu * width;
        ok = window::levenberg_marquardt(problem_, options, workspace_).ok;
    }
    problem_.loss.threshold = width;
    if (!ok) return false;
    if (!window::assemble_data(problem_, 0.0, workspace_)) return false;
    H_data_ = workspace_.S;
    g_data_ = workspace_.g;
    X_data_ = X_window_ = problem_.X;
    window::scale_and_add_prior(problem_, problem_.X, workspace_);
    workspace_.llt.compute(workspace_.S);
    return workspace_.llt.info() == Eigen::Success;
}

MatX Structure::covariance() const {
    MatX Sigma = Sigma_;
    if (fused_ > 0) window::add_gauge_curvature(problem_.X, Sigma);
    return Sigma;
}

/// The factors of the prior, ever more rarely: the data say the less news of them the more there are.
void Structure::judge_prior() noexcept {
    if (++fused_ < next_judgement_) return;
    next_judgement_ = fused_ + 1 + fused_ / 4;
    window::update_prior_factors(problem_, H_data_, g_data_, X_data_, workspace_);
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
        usable = window::linearise(problem_.camera, problem_.X, problem_.told_loss(), view) &&
                 window::factor_state(0.0, view);
        if (usable && iteration < 2)
            view.state.T_camera_target =
                perturb(view.state.T_camera_target, -(view.L_inverse.transpose() * (view.L_inverse * view.g)));
    }
    if (usable && problem_.compressed) problem_.compressed->add(view, problem_.X);
    retire(index);
}

void Structure::retire(std::size_t index) noexcept {
    std::swap(problem_.views[index], problem_.views.back());
    pool_.push_back(std::move(problem_.views.back()));
    problem_.views.pop_back();
}

Fusion Structure::fuse(std::int64_t stamp_ns, const SE3& T_start, std::span<const Observation> observations) noexcept {
    Fusion fusion;
    ViewBlock view = std::move(pool_.back());
    pool_.pop_back();
    view.stamp_ns = stamp_ns;
    view.state.T_camera_target = T_start;
    view.measurements.clear();
    for (const Observation& o : observations) view.measurements.push_back({o.landmark, o.z, o.covariance.inverse()});
    problem_.views.push_back(std::move(view));
    std::copy(problem_.X.begin(), problem_.X.end(), workspace_.X_trial.begin());
    if (!join_newest()) {
        std::copy(workspace_.X_trial.begin(), workspace_.X_trial.end(), problem_.X.begin());
        retire(problem_.views.size() - 1);
        return fusion;
    }
    const bool few = problem_.views.size() <= kFewViews;
    const double error = nonlinearity();
    const bool stale = few || error > kNonlinearity;
    if (!stale || !relinearise(few || error > kNews ? kWidest : 1.0)) {
        if (!newest_system(1.0)) return retire(problem_.views.size() - 1), fusion;
        absorb_newest();
    }
    publish();
    const ViewBlock& newest = problem_.views.back();
    fusion.T_camera_target = newest.state.T_camera_target;
    fusion.squares = newest.weighted_squares;
    fusion.covariance = window::state_covariance(newest, problem_.X, Sigma_, problem_.noise_factor, Yt_, SigmaYt_);
    const double log_det = workspace_.llt.matrixLLT().diagonal().array().log().sum();
    fusion.information_gained = std::max(0.0, log_det - log_det_);
    log_det_ = log_det;
    window::update_noise_factor(problem_, determined_);
    judge_prior();
    if (problem_.views.size() > max_views_) spare_one();
    fusion.ok = fusion.covariance.allFinite() && fusion.T_camera_target.t.allFinite();
    return fusion;
}

}  // namespace fairlead
