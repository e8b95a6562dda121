// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/structure.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "fairlead/tracker/entries.hpp"

namespace fairlead {
namespace {

using window::ViewBlock;

constexpr int kJoinIterations = 8;
constexpr double kJoinStep = 0.01;      // squared step [sigma^2] below which the newest view is settled
constexpr double kNonlinearity = 0.01;  // [sigma] error of the quadratic before its views are relinearised

}  // namespace

Structure::Structure(const Camera& camera, std::span<const Vec3> X0, const MatX& P0, const TrackerOptions& options)
    : aside_(set_aside(options)),
      landmarks_(X0.size() - static_cast<std::size_t>(aside_)),
      workspace_(static_cast<int>(X0.size())),
      kind_(options.motion),
      jerk_density_(options.jerk_density_m_s25),
      shares_(options),
      max_views_(static_cast<std::size_t>(options.max_views)) {
    validate(camera);
    problem_.camera = camera;
    problem_.prior = window::make_prior(X0, P0, aside_);
    for (const window::Gauge gauge : {window::Gauge::similarity, window::Gauge::rigid})
        problem_.compressed.emplace_back(window::Reference{X0, gauge, aside_});
    if (kind_ != motion::Kind::none) {
        const window::Reference reference{X0, window::Gauge::similarity, aside_};
        path_.emplace(kind_, jerk_density_, reference);
        problem_.path.emplace(reference);
    }
    problem_.X.assign(X0.begin(), X0.end());
    problem_.loss.threshold = options.loss_threshold;
    problem_.design_effect = problem_.pose_factor = options.design_effect;
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(X0.size());
    data_ = {MatX::Zero(n, n), VecX::Zero(n), problem_.X};
    shift_.setZero(n);
    X_window_ = problem_.X;
    Yt_.setZero(n, window::ViewState::kDim);
    SigmaYt_ = Yt_;
    Sigma_ = P0;
    blocks_.resize(X0.size());
    squares_.reserve(X0.size());
    for (std::size_t j = 0; j < X0.size(); ++j) {
        const Eigen::Index row = 3 * static_cast<Eigen::Index>(j);
        blocks_[j] = P0.block<3, 3>(row, row);
        if (j < landmarks_) radius_ = std::max(j == 0 ? 0.0 : radius_, (X0[j] - X0[0]).norm());
    }
    const std::size_t capacity = max_views_ + 1;
    problem_.views.reserve(capacity);
    workspace_.dT.reserve(capacity);
    workspace_.T_before.reserve(capacity);
    descriptors_.resize(capacity);
    for (std::size_t k = 0; k < capacity; ++k) pool_.emplace_back(static_cast<int>(X0.size()));
    window::scale_and_add_prior(problem_, problem_.X, workspace_);
    log_det_ = Eigen::LLT<MatX>(workspace_.S).matrixLLT().diagonal().array().log().sum();
}

void Structure::expect_ranges() {
    if (!path_ || path_gauge_ == window::Gauge::rigid) return;
    path_gauge_ = window::Gauge::rigid;
    const std::vector<Vec3> X_ref = told();
    const window::Reference reference{X_ref, path_gauge_, aside_};
    path_->marginal(workspace_.product, workspace_.D);
    problem_.compressed.front().add(workspace_.product, workspace_.D, problem_.noise_factor);
    path_.emplace(kind_, jerk_density_, reference);
    problem_.path.emplace(reference);
    stale_ = true;
}

std::vector<Vec3> Structure::landmarks_told() const {
    std::vector<Vec3> X = told();
    X.resize(landmarks_);
    return X;
}

std::vector<Vec3> Structure::told() const {
    std::vector<Vec3> X;
    for (Eigen::Index j = 0; j < problem_.prior->mean.size(); j += 3)
        X.emplace_back(problem_.prior->mean.segment<3>(j));
    return X;
}

void Structure::interrupt() noexcept {
    if (path_) path_->restart();
}

std::optional<double> Structure::range_rate() const noexcept {
    return on_path_ ? std::optional<double>(path_->range_rate()) : std::nullopt;
}

/// The joint system of newest view and model: everything older is the quadratic. mu widens the loss.
bool Structure::newest_system(double mu) noexcept {
    ViewBlock& view = problem_.views.back();
    const Loss loss{mu * problem_.told_loss().threshold};
    if (!window::linearise(problem_.camera, problem_.X, loss, problem_.noise_factor, view) ||
        !window::factor_state(0.0, view))
        return false;
    window::assemble(data_, problem_.X, workspace_);
    if (!on_path_) {
        workspace_.eliminator.add(view, problem_.X, workspace_.S, workspace_.g);
        workspace_.eliminator.flush(workspace_.S);
    }
    window::scale_and_add_prior(problem_, problem_.X, workspace_);
    if (on_path_ && !path_->join(view, problem_.X, problem_.noise_factor, workspace_.S, workspace_.g)) return false;
    return workspace_.cholesky.factor(workspace_.S);
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
        workspace_.cholesky.solve_in_place(workspace_.dX);
        const double states =
            on_path_ ? path_->decrease() : (view.L_inverse * view.g).squaredNorm() / problem_.noise_factor;
        if (mu == 1.0 && states - workspace_.g.dot(workspace_.dX) < kJoinStep) return true;
        const window::StateVector dT =
            on_path_ ? path_->step(workspace_.dX) : window::back_substitute(view, problem_.X, workspace_.dX);
        if (!workspace_.dX.allFinite() || !dT.allFinite()) return false;
        view.state.T_camera_target = perturb(view.state.T_camera_target, dT);
        for (std::size_t j = 0; j < problem_.X.size(); ++j)
            problem_.X[j] += workspace_.dX.segment<3>(3 * static_cast<Eigen::Index>(j));
        mu = std::max(1.0, 0.25 * mu);
    }
    return newest_system(1.0);
}

/// The view as the solver wants it. Of detections that err alike, a view like those before it says little new:
/// docs/motion.md eq. (12).
ViewBlock Structure::make_view(std::int64_t stamp_ns, const SE3& T_start, std::span<const Observation> observations,
                               std::span<const window::RangeMeasurement> ranges) noexcept {
    ViewBlock view = std::move(pool_.back());
    pool_.pop_back();
    view.stamp_ns = stamp_ns;
    view.state.T_camera_target = T_start;
    view.measurements.clear();
    for (const Observation& o : observations) view.measurements.push_back({o.landmark, o.z, o.covariance.inverse()});
    view.ranges.assign(ranges.begin(),
                       ranges.begin() + std::min<std::ptrdiff_t>(std::ssize(ranges), ViewBlock::kMaxRanges));
    if (aside_ > 0)
        for (window::RangeMeasurement& range : view.ranges) range.bias = problem_.landmarks() - 1;
    view.share = shares_.of(outlook(stamp_ns, T_start, landmarks()));
    return view;
}

/// Off the path: the view stays in the window, or replaces the one that can be spared.
bool Structure::settle_newest(double error) noexcept {
    const bool few = problem_.views.size() <= kFewViews;
    const bool stale = few || stale_ || error > kNonlinearity;
    if (!stale || !relinearise(error)) {
        if (!newest_system(1.0)) return false;
        absorb_newest();
    }
    return true;
}

/// On the path: the view becomes part of the path's past.
void Structure::settle_on_path(double error) noexcept {
    pool_.push_back(path_->settle(std::move(problem_.views.back()), problem_));
    problem_.views.pop_back();
    if (stale_ || error > kNonlinearity) stale_ = !relinearise(error);
}

/// Where the newest view sees the target, and how well it is known, from what is linearised.
void Structure::locate_newest(Fusion& fusion) noexcept {
    const ViewBlock& newest = problem_.views.back();
    fusion.T_camera_target = newest.state.T_camera_target;
    fusion.covariance = on_path_
                            ? path_->covariance(newest, problem_, Sigma_)
                            : window::state_covariance(newest, problem_.X, Sigma_, problem_.pose_factor, Yt_, SigmaYt_);
}

/// A view errs as told, however much its errors are like those before: its pose is what the whole view says,
/// docs/motion.md eq. (13). The model has learned of those errors already and is put back.
bool Structure::locate_by_whole_view(Fusion& fusion) noexcept {
    double& share = problem_.views.back().share;
    double& believed = problem_.prior_factors.believed;
    const double told = std::exchange(share, 1.0);
    const double cautious = std::exchange(believed, problem_.prior_factors.likely);
    const bool joined = join_newest();
    if (joined) {
        publish();
        locate_newest(fusion);
    }
    share = told;
    believed = cautious;
    std::copy(workspace_.X_before.begin(), workspace_.X_before.end(), problem_.X.begin());
    return joined;
}

Fusion Structure::fuse(std::int64_t stamp_ns, const SE3& T_start, std::span<const Observation> observations,
                       std::span<const window::RangeMeasurement> ranges,
                       const std::optional<motion::Attitude>& attitude) noexcept {
    Fusion fusion;
    problem_.views.push_back(make_view(stamp_ns, T_start, observations, ranges));
    on_path_ = path_ && problem_.views.size() > kFewViews;
    if (on_path_) path_->advance(stamp_ns, problem_.X, attitude);
    std::copy(problem_.X.begin(), problem_.X.end(), workspace_.X_before.begin());
    const bool alike = problem_.views.back().share < 1.0;
    const bool joined = (!alike || locate_by_whole_view(fusion)) && join_newest();
    const double error = joined ? nonlinearity() : 0.0;
    if (!joined || (!on_path_ && !settle_newest(error))) {
        std::copy(workspace_.X_before.begin(), workspace_.X_before.end(), problem_.X.begin());
        retire(problem_.views.size() - 1);
        return fusion;
    }
    shares_.take();
    publish();
    if (!alike) locate_newest(fusion);
    const double log_det = workspace_.cholesky.half_log_det();
    fusion.information_gained = std::max(0.0, log_det - log_det_);
    log_det_ = log_det;
    window::update_noise_factor(problem_, determined_);
    judge_prior();
    if (on_path_)
        settle_on_path(error);
    else if (problem_.views.size() > max_views_)
        spare_one();
    fusion.ok = fusion.covariance.allFinite() && fusion.T_camera_target.t.allFinite();
    return fusion;
}

}  // namespace fairlead
