// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fairlead/motion/path.hpp"
#include "fairlead/refine.hpp"
#include "fairlead/tracker/entries.hpp"
#include "fairlead/tracker/start_pose.hpp"
#include "fairlead/window/covariance.hpp"
#include "fairlead/window/levenberg_marquardt.hpp"

namespace fairlead {

/// One view of the batch and where it stands in the problem (-1: not solved).
struct Candidate {
    std::vector<Observation> observations;
    std::int64_t stamp_ns = 0;
    std::vector<window::RangeMeasurement> ranges;
    std::optional<motion::Attitude> attitude;
    int dropped = 0;
    int view = -1;
    int on_path = -1;  ///< its place on the path, where there is one
    Reason reason = Reason::none;
    std::optional<SE3> twin;     ///< another pose that explains the view nearly as well
    double twin_nats = 0.0;      ///< by how much less well
    std::optional<Mat66> whole;  ///< covariance of a pose that the whole view was asked for
};

[[nodiscard]] double decided(const Candidate& candidate);

/// All views of a flight and their joint solution, docs/estimator.md section 5.
class Batch {
  public:
    /// X0 and P0 with the entries that the options append.
    Batch(const Camera& camera, std::span<const Vec3> X0, const MatX& P0, const TrackerOptions& options);

    void add(const BatchView& view);
    /// After the views. Throws std::invalid_argument for readings that mean nothing.
    void add(const BatchReadings& readings);
    Refinement solve();

  private:
    void share_information();
    void add_ranges(std::vector<BatchReadings::Range> ranges);
    void add_attitudes(std::span<const BatchReadings::Attitude> attitudes);
    [[nodiscard]] std::vector<Candidate*> in_time();

    [[nodiscard]] std::optional<Prediction> neighbour(const Candidate& candidate) const;
    bool start_missing_views();
    bool take_second_look();
    double doubted_cost(const Candidate& candidate, const SE3& T);
    void locate_by_whole_views();
    void locate(Candidate& candidate, window::ViewBlock& view);
    double widest_loss();
    bool solve_widened(double mu, int max_iterations);
    void graduate(double mu);
    void measure_structure();
    void update_blocks();

    void start_path();
    [[nodiscard]] double cost_without_motion();
    void settle_on_path();

    Refinement result();
    [[nodiscard]] Estimate estimate(const Candidate& candidate, std::vector<int>& inliers) const;
    [[nodiscard]] const window::ViewBlock& block(const Candidate& candidate) const;
    [[nodiscard]] Mat66 covariance(const Candidate& candidate) const;

    /// How many were told.
    [[nodiscard]] std::size_t landmarks() const {
        return problem_.X.size() - static_cast<std::size_t>(appended_entries(options_));
    }
    /// The entries of X that are landmarks, told or appended.
    [[nodiscard]] std::span<const Vec3> points() const {
        return std::span(problem_.X).first(problem_.X.size() - static_cast<std::size_t>(set_aside(options_)));
    }
    [[nodiscard]] UncertainModel model() const { return {problem_.X, blocks_}; }
    [[nodiscard]] double cost(const window::ViewBlock& view, const SE3& T) const {
        return window::view_cost(problem_.camera, problem_.X, problem_.told_loss(), problem_.noise_factor, T, view);
    }

    TrackerOptions options_;
    window::Problem problem_;
    window::Workspace workspace_;
    window::Quadratic data_;  ///< of all views
    MatX Sigma_;
    std::vector<Mat33> blocks_;
    std::vector<Candidate> candidates_;
    std::vector<Observation> scratch_;
    window::LmSummary last_;
    double determined_ = 0.0;  ///< directions of the model that the data determine
    int iterations_ = 0;
    int believed_ = 0, refused_ = 0;

    std::optional<motion::Path> path_;
    std::vector<Mat66> path_covariances_;
};

}  // namespace fairlead
