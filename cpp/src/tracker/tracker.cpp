// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fairlead/tracker/coast.hpp"
#include "fairlead/tracker/hypotheses.hpp"
#include "fairlead/tracker/readings.hpp"
#include "fairlead/tracker/sanitise.hpp"
#include "fairlead/tracker/structure.hpp"

namespace fairlead {
namespace {

constexpr int kClockConfirmations = 10;  // views with earlier stamps, in order, that are a new clock, not stray ones
constexpr double kSameStep = 0.35;       // [rad] turn within which two views agree about a jump
constexpr double kRateShare = 0.1;  // how far the closing speed of a smooth path may be off, one standard deviation
constexpr double kDecisiveShare = 0.75;  // inliers that make a jump evident at once

double turn(const SE3& a, const SE3& b) { return so3::log(a.R.transpose() * b.R).norm(); }

}  // namespace

struct Tracker::State {
    State(const Camera& camera_in, std::span<const Vec3> X0, const MatX& P0, const TrackerOptions& options_in)
        : camera(camera_in),
          options(options_in),
          landmarks(X0.size() - static_cast<std::size_t>(appended_entries(options_in))),
          structure(camera_in, X0, P0, options_in) {
        for (auto* list : {&clean, &scratch, &kept}) list->reserve(X0.size());
        inliers.reserve(X0.size());
    }

    Camera camera;
    TrackerOptions options;
    std::size_t landmarks;  ///< the origin, where it is one more, not counted
    Structure structure;
    Readings readings;
    Coast coast;
    Hypotheses hypotheses;
    Status status = Status::acquiring;
    std::int64_t last_stamp_ns = 0;
    bool has_stamp = false;
    int stray_stamps = 0;
    std::int64_t stray_stamp_ns = 0;
    int resets = 0;
    bool jump_pending = false;
    int jump_views = 0;
    SE3 jump_T;
    std::vector<Observation> clean, scratch, kept;
    std::vector<int> inliers;

    [[nodiscard]] UncertainModel model() const noexcept {
        return {structure.landmarks(), structure.landmark_covariances()};
    }
    bool stamp_is_stray(std::int64_t stamp_ns) noexcept;
    bool jump_is_unproven(const StartPose& start) noexcept;
    Estimate without_fresh_pose(Estimate estimate, Reason reason) noexcept;
    Estimate undecided(Estimate estimate) noexcept;
    Estimate fused(Estimate estimate, const SE3& T_start, bool continuous) noexcept;
    void keep_inliers(const SE3& T) noexcept;
    void describe_residuals(Estimate& estimate) noexcept;
    Estimate update(std::int64_t stamp_ns, std::span<const Observation> observations) noexcept;
};

bool Tracker::State::stamp_is_stray(std::int64_t stamp_ns) noexcept {
    if (!has_stamp || stamp_ns > last_stamp_ns) {
        stray_stamps = 0;
        return false;
    }
    stray_stamps = stray_stamps > 0 && stamp_ns > stray_stamp_ns ? stray_stamps + 1 : 1;
    stray_stamp_ns = stamp_ns;
    if (stray_stamps < kClockConfirmations) return true;
    stray_stamps = 0;  // the clock was set back: go on from here
    if (status != Status::acquiring) status = Status::lost;
    return false;
}

/// A turn beyond max_step_rad is believed at once only if the view leaves no doubt, else after several views that
/// agree.
bool Tracker::State::jump_is_unproven(const StartPose& start) noexcept {
    const pnp::RefineResult& best = start.poses.best;
    const SE3& T = best.T_camera_target;
    if (start.from_prediction || turn(coast.pose(), T) <= options.max_step_rad) return jump_pending = false;
    const double margin = start.poses.distinct ? 0.5 * (start.poses.other.cost - best.cost) : 1e9;
    const bool decisive = best.inliers >= 6 && best.inliers >= kDecisiveShare * static_cast<double>(clean.size()) &&
                          margin > 2.0 * options.ambiguity_log_odds;
    jump_views = jump_pending && turn(jump_T, T) < kSameStep ? jump_views + 1 : 1;
    jump_T = T;
    jump_pending = !decisive && jump_views < options.confirmations;
    return jump_pending;
}

Estimate Tracker::State::without_fresh_pose(Estimate estimate, Reason reason) noexcept {
    if (status == Status::acquiring || status == Status::lost) return without_pose(estimate, status, reason);
    if (coast.age_s(estimate.stamp_ns) > options.coast_limit_s) {
        status = Status::lost;
        hypotheses.drop();
        return without_pose(estimate, status, reason);
    }
    status = estimate.status = Status::coasting;
    estimate.reason = reason;
    estimate.T_camera_target = coast.pose();
    estimate.covariance = coast.covariance(estimate.stamp_ns);
    if (reason == Reason::too_few && !clean.empty()) {
        inflate(camera, model(), coast.pose(), structure.noise_factor(), clean, scratch);
        update_pose(camera, model(), scratch, estimate.T_camera_target, estimate.covariance);
    }
    return estimate;
}

Estimate Tracker::State::undecided(Estimate estimate) noexcept {
    const pnp::RefineResult& best = hypotheses.best();
    status = estimate.status = Status::tracking;
    estimate.reason = Reason::ambiguous;
    estimate.T_camera_target = best.T_camera_target;
    estimate.covariance = hypotheses.covariance();
    coast.restart(estimate.stamp_ns, estimate.T_camera_target, estimate.covariance);
    keep_inliers(estimate.T_camera_target);
    describe_residuals(estimate);
    return estimate;
}

/// Chi-square gate of every observation at T, the model's own error taken into account.
void Tracker::State::keep_inliers(const SE3& T) noexcept {
    inflate(camera, model(), T, structure.noise_factor(), clean, scratch);
    kept.clear();
    inliers.clear();
    for (std::size_t i = 0; i < clean.size(); ++i) {
        Vec2 z;
        if (!camera.project(T * structure.landmarks()[static_cast<std::size_t>(clean[i].landmark)], z)) continue;
        const Vec2 r = z - clean[i].z;
        if (r.dot(scratch[i].covariance.inverse() * r) > options.gate) continue;
        kept.push_back(clean[i]);
        inliers.push_back(clean[i].landmark);
    }
}

void Tracker::State::describe_residuals(Estimate& estimate) noexcept {
    double squares = 0.0;
    for (const Observation& o : kept) {
        Vec2 z;
        if (camera.project(estimate.T_camera_target * structure.landmarks()[static_cast<std::size_t>(o.landmark)], z))
            squares += (z - o.z).squaredNorm();
    }
    estimate.inliers = static_cast<int>(kept.size());
    estimate.inlier_landmarks = inliers;
    if (!kept.empty()) estimate.reprojection_rms_px = std::sqrt(squares / (2.0 * static_cast<double>(kept.size())));
}

Estimate Tracker::State::fused(Estimate estimate, const SE3& T_start, bool continuous) noexcept {
    keep_inliers(T_start);
    if (kept.size() < 4) return without_fresh_pose(estimate, Reason::gated);
    if (!continuous) structure.interrupt();
    const std::optional<double> smooth_rate = structure.range_rate();
    const auto ranges =
        readings.ranges_at(estimate.stamp_ns, smooth_rate.value_or(coast.range_rate()), smooth_rate ? kRateShare : 1.0);
    const Fusion fusion =
        structure.fuse(estimate.stamp_ns, T_start, kept, ranges, readings.attitude_at(estimate.stamp_ns));
    if (!fusion.ok) return without_fresh_pose(estimate, Reason::diverged);
    estimate.T_camera_target = fusion.T_camera_target;
    estimate.covariance = fusion.covariance;
    estimate.information_gained = fusion.information_gained;
    if (continuous) {
        coast.observe(estimate.stamp_ns, estimate.T_camera_target, estimate.covariance);
    } else {
        if (status != Status::acquiring) ++resets;
        coast.restart(estimate.stamp_ns, estimate.T_camera_target, estimate.covariance);
    }
    status = estimate.status = Status::tracking;
    estimate.resets = resets;
    estimate.reason = doubt(structure.noise_factor(), structure.prior_factor(), structure.contradicts_prior());
    describe_residuals(estimate);
    return estimate;
}

Estimate Tracker::State::update(std::int64_t stamp_ns, std::span<const Observation> observations) noexcept {
    Estimate estimate;
    estimate.stamp_ns = stamp_ns;
    estimate.resets = resets;
    const std::span<const Observation> taken = observations.first(std::min(observations.size(), std::size_t{1} << 20));
    estimate.dropped = sanitise(taken, static_cast<int>(landmarks), clean);
    if (stamp_is_stray(stamp_ns))
        return without_pose(estimate, status == Status::acquiring ? status : Status::lost, Reason::stamp);
    last_stamp_ns = stamp_ns;
    has_stamp = true;

    const bool following = status == Status::tracking || status == Status::coasting;
    if (following && hypotheses.active()) {
        if (clean.size() < 4) return without_fresh_pose(estimate, Reason::too_few);
        if (!hypotheses.update(camera, model(), clean, structure.noise_factor(), options, scratch)) {
            hypotheses.drop();
            return without_fresh_pose(estimate, Reason::no_consensus);
        }
        if (hypotheses.active()) return undecided(estimate);
        return fused(estimate, hypotheses.best().T_camera_target, true);
    }
    std::optional<Prediction> predicted;
    if (following) predicted = Prediction{coast.pose(), coast.covariance(stamp_ns)};
    const StartPose start = find_start(camera, model(), clean, predicted, structure.noise_factor(), options, scratch);
    if (start.reason != Reason::none) return without_fresh_pose(estimate, start.reason);
    if (following && jump_is_unproven(start)) return without_fresh_pose(estimate, Reason::gated);
    if (hypotheses.consider(start.poses, options.ambiguity_log_odds)) return undecided(estimate);
    return fused(estimate, start.poses.best.T_camera_target, start.from_prediction);
}

Tracker::Tracker(const Camera& camera, std::span<const Vec3> X0, const MatX& P0, const TrackerOptions& options) {
    validate(options);
    validate(camera);
    require(X0.size() >= 4, "landmarks", std::to_string(X0.size()), "at least 4 (a pose needs them)");
    std::vector<Vec3> X(X0.begin(), X0.end());
    MatX P = P0;
    append_entries(options, X, P);
    state_ = std::make_unique<State>(camera, X, P, options);
}

void Tracker::add_length(int a, int b, double length_m, double sigma_m) {
    require_length({a, b, length_m, sigma_m}, static_cast<int>(state_->landmarks));
    state_->structure.add_length({a, b, length_m, sigma_m});
}

void Tracker::add_range(std::int64_t stamp_ns, double range_m, double sigma_m, int landmark) {
    const int number = range_landmark(landmark, static_cast<int>(state_->landmarks), state_->options);
    state_->readings.add_range(stamp_ns, {number, range_m, sigma_m});
    state_->structure.expect_ranges();
}

void Tracker::add_attitude(std::int64_t stamp_ns, const Mat33& R_world_camera, double sigma_rad) {
    state_->readings.add_attitude(stamp_ns, {R_world_camera, sigma_rad});
}

void Tracker::add_pose(std::int64_t stamp_ns, const SE3& T_camera_target, const Mat66& covariance) {
    require(is_rotation(T_camera_target.R) && T_camera_target.t.allFinite(), "T_camera_target", "another matrix",
            "a rigid motion");
    require(covariance.allFinite() && covariance.llt().info() == Eigen::Success, "covariance", "another matrix",
            "a symmetric positive definite one");
    if (state_->status == Status::tracking || state_->status == Status::coasting) return;
    state_->coast.restart(stamp_ns, T_camera_target, covariance);
    state_->status = Status::coasting;
}

Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

Estimate Tracker::update(std::int64_t stamp_ns, std::span<const Observation> observations) noexcept {
    return state_->update(stamp_ns, observations);
}

Estimate Tracker::predict(std::int64_t stamp_ns) const noexcept {
    Estimate estimate;
    estimate.stamp_ns = stamp_ns;
    estimate.resets = state_->resets;
    if (state_->status == Status::acquiring || state_->status == Status::lost)
        return without_pose(estimate, state_->status, Reason::none);
    return state_->coast.predict(estimate, state_->options.coast_limit_s);
}

std::span<const Vec3> Tracker::landmarks() const noexcept {
    return state_->structure.landmarks().first(state_->landmarks);
}
MatX Tracker::landmark_covariance() const {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(state_->landmarks);
    return state_->structure.covariance().topLeftCorner(n, n);
}
double Tracker::noise_factor() const noexcept { return state_->structure.noise_factor(); }
double Tracker::prior_factor() const noexcept { return state_->structure.prior_factor(); }
window::GaugeSigma Tracker::gauge_sigma_told() const {
    return window::gauge_sigma(state_->structure.landmarks_told(), state_->structure.covariance_told());
}
window::GaugeSigma Tracker::gauge_sigma() const {
    return window::gauge_sigma(state_->structure.landmarks(), state_->structure.covariance_linear());
}
double Tracker::determined_directions() const noexcept { return state_->structure.determined_directions(); }
double Tracker::predicted_gain(const SE3& T_camera_target, double sigma_px) const {
    return window::predicted_gain(state_->camera, state_->structure.landmarks(), state_->structure.covariance_linear(),
                                  T_camera_target, sigma_px);
}
RangeBias Tracker::range_bias() const noexcept {
    return fairlead::range_bias(state_->options, state_->structure.entries(), state_->structure.entries_covariance());
}
int Tracker::views_in_window() const noexcept { return state_->structure.views(); }
int Tracker::ranges_believed() const noexcept { return state_->readings.believed(); }
int Tracker::ranges_refused() const noexcept { return state_->readings.refused(); }

}  // namespace fairlead
