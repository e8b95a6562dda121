// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// All views at once from images: graduated loss and factors.
#include "batch.hpp"

#include <algorithm>
#include <cmath>

#include "fairlead/tracker/sanitise.hpp"
#include "fairlead/tracker/shares.hpp"

namespace fairlead {
namespace {

constexpr int kMeasurements = 12;       // at most, of the factors of noise and prior
constexpr double kFactorChange = 0.01;  // relative change of the factors that counts as settled
constexpr int kSecondLooks = 3;         // rounds in which views are tried from other poses
constexpr double kLeastShare = 1e-3;    // of a view that is as likely to have another pose

}  // namespace

Batch::Batch(const Camera& camera, std::span<const Vec3> X0, const MatX& P0, const TrackerOptions& options)
    : options_(options), workspace_(static_cast<int>(X0.size())), Sigma_(P0) {
    problem_.camera = camera;
    problem_.prior = window::make_prior(X0, P0, set_aside(options));
    problem_.X.assign(X0.begin(), X0.end());
    problem_.design_effect = problem_.pose_factor = options.design_effect;
    scratch_.reserve(X0.size());
    update_blocks();
}

void Batch::add(const BatchView& view) {
    Candidate candidate;
    candidate.stamp_ns = view.stamp_ns;
    candidate.observations.reserve(problem_.X.size());
    candidate.dropped = sanitise(view.observations, static_cast<int>(landmarks()), candidate.observations);
    candidates_.push_back(std::move(candidate));
}

Refinement Batch::solve() {
    start_missing_views();
    share_information();
    if (!problem_.views.empty()) graduate(widest_loss());
    for (int round = 0; round < kSecondLooks && !problem_.views.empty(); ++round) {
        const bool added = start_missing_views();
        const bool moved = take_second_look();
        if (!added && !moved) break;
        share_information();
        graduate(1.0);
    }
    if (last_.ok && options_.motion != motion::Kind::none)
        start_path();
    else if (last_.ok)
        locate_by_whole_views();
    return result();
}

/// Covariance of the landmarks at the system that was assembled, and the directions that the data determine.
void Batch::measure_structure() {
    window::scale_and_add_prior(problem_, problem_.X, workspace_);
    if (!workspace_.cholesky.factor(workspace_.S)) return;
    determined_ = window::structure_covariance(problem_, workspace_, Sigma_);
    update_blocks();
}

void Batch::update_blocks() {
    blocks_.resize(problem_.X.size());
    for (std::size_t j = 0; j < blocks_.size(); ++j) {
        const Eigen::Index row = 3 * static_cast<Eigen::Index>(j);
        blocks_[j] = Sigma_.block<3, 3>(row, row);
    }
}

/// How much a view may teach of the model: the squared difference of the probabilities of its two poses,
/// docs/estimator.md eq. (21). Taken at its likelier pose, it would bend the model towards whatever the noise made so.
double decided(const Candidate& candidate) {
    return candidate.twin ? std::max(std::pow(std::tanh(0.5 * candidate.twin_nats), 2), kLeastShare) : 1.0;
}

/// Of detections that err alike, docs/motion.md eq. (12), and of views that may have another pose.
void Batch::share_information() {
    Shares shares(options_);
    for (const Candidate* candidate : in_time()) {
        if (candidate->view < 0) continue;
        window::ViewBlock& view = problem_.views[static_cast<std::size_t>(candidate->view)];
        view.share = decided(*candidate) * shares.of(outlook(view.stamp_ns, view.state.T_camera_target, points()));
        shares.take();
    }
}

/// How much wider than its own threshold the loss must begin, so that it takes in what the wrong model does to inliers
/// (90 % point).
double Batch::widest_loss() {
    std::vector<double> ratios;
    for (const Candidate& candidate : candidates_) {
        if (candidate.view < 0) continue;
        const SE3& T = problem_.views[static_cast<std::size_t>(candidate.view)].state.T_camera_target;
        inflate(problem_.camera, model(), T, 1.0, candidate.observations, scratch_);
        for (std::size_t i = 0; i < scratch_.size(); ++i) {
            Vec2 z;
            if (!problem_.camera.project(T * problem_.X[static_cast<std::size_t>(scratch_[i].landmark)], z)) continue;
            const Vec2 r = z - scratch_[i].z;
            if (r.dot(scratch_[i].covariance.inverse() * r) > options_.loss_threshold) continue;
            ratios.push_back(r.dot(candidate.observations[i].covariance.inverse() * r) / options_.loss_threshold);
        }
    }
    if (ratios.empty()) return 1.0;
    const auto high = ratios.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(ratios.size() - 1));
    std::nth_element(ratios.begin(), high, ratios.end());
    return std::max(1.0, *high);
}

/// The joint solution with a loss mu times as wide.
bool Batch::solve_widened(double mu, int max_iterations) {
    problem_.loss.threshold = mu * options_.loss_threshold;
    last_ = window::levenberg_marquardt(problem_, {.max_iterations = max_iterations}, workspace_);
    iterations_ += last_.iterations;
    return last_.ok;
}

/// Graduated non-convexity: the loss narrows by four. The factors are measured at its own width, until they have
/// settled: a wide one takes in outliers, which would widen it further.
void Batch::graduate(double mu) {
    for (; mu > 1.0; mu = std::max(1.0, 0.25 * mu))
        if (!solve_widened(mu, 6)) return;
    for (int round = 0; round < kMeasurements; ++round) {
        if (!solve_widened(1.0, 50) || !window::assemble_data(problem_, 0.0, workspace_)) return;
        data_ = {workspace_.S, workspace_.g, problem_.X};
        measure_structure();
        const double noise = problem_.noise_factor;
        const double prior = problem_.prior_factors.believed;
        window::update_noise_factor(problem_, determined_);
        window::update_prior_factors(problem_, data_, workspace_);
        const double change = std::max(std::abs(problem_.noise_factor / noise - 1.0),
                                       std::abs(problem_.prior_factors.believed / prior - 1.0));
        if (change < kFactorChange) return;
    }
}

}  // namespace fairlead
