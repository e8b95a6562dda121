// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/motion/path.hpp"
#include "fairlead/tracker/options.hpp"
#include "fairlead/tracker/shares.hpp"
#include "fairlead/window/covariance.hpp"
#include "fairlead/window/levenberg_marquardt.hpp"

namespace fairlead {

/// What a view was worth once fused with everything before it.
struct Fusion {
    bool ok = false;
    SE3 T_camera_target;
    Mat66 covariance = Mat66::Zero();
    double information_gained = 0.0;  ///< [nats]
};

/// The landmark model and all that the views said about it: a bounded window of views that are relinearised, and the
/// compressed rest. Between relinearisations everything but the newest view is one quadratic in X. docs/estimator.md
/// section 4.
class Structure {
  public:
    /// Throws std::invalid_argument for a bad camera, prior or capacity.
    Structure(const Camera& camera, std::span<const Vec3> X0, const MatX& P0, const TrackerOptions& options);

    void add_length(const window::LengthMeasurement& length) { problem_.lengths.push_back(length); }
    /// From now on views may carry ranges: what is on the path keeps its scale.
    void expect_ranges();
    /// The next view is not a continuation of the last.
    void interrupt() noexcept;

    /// Joint estimate of X and this view's pose, starting from T_start; the view stays in the window or is compressed.
    /// Allocates nothing.
    [[nodiscard]] Fusion fuse(std::int64_t stamp_ns, const SE3& T_start, std::span<const Observation> observations,
                              std::span<const window::RangeMeasurement> ranges,
                              const std::optional<motion::Attitude>& attitude) noexcept;

    [[nodiscard]] std::span<const Vec3> landmarks() const noexcept { return std::span(problem_.X).first(landmarks_); }
    [[nodiscard]] std::span<const Mat33> landmark_covariances() const noexcept { return blocks_; }
    /// What is reported of the model: the covariance with the curvature of its gauge.
    [[nodiscard]] MatX covariance() const;
    [[nodiscard]] MatX covariance_linear() const { return of_landmarks(Sigma_); }
    [[nodiscard]] std::vector<Vec3> landmarks_told() const;
    [[nodiscard]] MatX covariance_told() const { return of_landmarks(problem_.prior->information).inverse(); }
    /// The entries of X and their covariance, what is no landmark included.
    [[nodiscard]] std::span<const Vec3> entries() const noexcept { return problem_.X; }
    [[nodiscard]] const MatX& entries_covariance() const noexcept { return Sigma_; }
    [[nodiscard]] double determined_directions() const noexcept { return determined_; }
    [[nodiscard]] double noise_factor() const noexcept { return problem_.noise_factor; }
    [[nodiscard]] double prior_factor() const noexcept { return problem_.prior_factors.likely; }
    [[nodiscard]] bool contradicts_prior() const noexcept { return window::contradicts_prior(problem_, determined_); }
    /// d range / dt [m/s] where a motion prior tells it.
    [[nodiscard]] std::optional<double> range_rate() const noexcept;
    [[nodiscard]] int views() const noexcept { return static_cast<int>(problem_.views.size()); }

  private:
    static constexpr std::size_t kFewViews = 16;  ///< windows this small are always solved anew
    [[nodiscard]] window::ViewBlock make_view(std::int64_t stamp_ns, const SE3& T_start,
                                              std::span<const Observation> observations,
                                              std::span<const window::RangeMeasurement> ranges) noexcept;
    [[nodiscard]] bool settle_newest(double error) noexcept;
    void settle_on_path(double error) noexcept;
    void locate_newest(Fusion& fusion) noexcept;
    bool locate_by_whole_view(Fusion& fusion) noexcept;
    bool join_newest() noexcept;
    bool newest_system(double mu) noexcept;
    bool relinearise(double error) noexcept;
    bool solve_window(double widest) noexcept;
    bool follow_model() noexcept;
    void absorb_newest() noexcept;
    void spare_one() noexcept;
    void retire(std::size_t index) noexcept;
    double nonlinearity() noexcept;
    void publish() noexcept;
    void judge_prior() noexcept;

    [[nodiscard]] std::vector<Vec3> told() const;
    [[nodiscard]] MatX of_landmarks(const MatX& all) const {
        const auto n = 3 * static_cast<Eigen::Index>(landmarks_);
        return all.topLeftCorner(n, n);
    }

    int aside_;              ///< entries of X that are no landmarks, the last ones
    std::size_t landmarks_;  ///< the others
    window::Problem problem_;
    window::Workspace workspace_;
    std::vector<window::ViewBlock> pool_;
    std::vector<Eigen::Vector4d> descriptors_;
    double radius_ = 1.0;
    motion::Kind kind_;
    double jerk_density_;
    Shares shares_;
    std::optional<motion::Path> path_;
    window::Gauge path_gauge_ = window::Gauge::similarity;
    bool stale_ = false;    ///< the window must be linearised anew
    bool on_path_ = false;  ///< whether the newest view is

    window::Quadratic data_;      ///< of all but the newest view
    std::vector<Vec3> X_window_;  ///< where its views were linearised

    MatX Sigma_, Yt_, SigmaYt_;
    VecX shift_;
    std::vector<Mat33> blocks_;
    std::vector<double> squares_;
    double log_det_ = 0.0;
    double determined_ = 0.0;
    int fused_ = 0, next_judgement_ = 1;
    std::size_t max_views_;
};

}  // namespace fairlead
