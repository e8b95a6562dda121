// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "fairlead/pnp/observation.hpp"
#include "fairlead/tracker/entries.hpp"
#include "fairlead/tracker/estimate.hpp"
#include "fairlead/tracker/options.hpp"
#include "fairlead/window/observability.hpp"

namespace fairlead {

/// Pose of a roughly known target in every view, and the model getting better as views come in (mode `map`).
/// docs/estimator.md.
///
/// All memory is taken at construction; update() allocates nothing, throws nothing and reads no clock.
class Tracker {
  public:
    /// X0: landmarks in the target frame [m]; P0: their covariance (window::landmark_covariance makes the usual one).
    /// Throws std::invalid_argument for a bad camera, model, covariance or option.
    Tracker(const Camera& camera, std::span<const Vec3> X0, const MatX& P0, const TrackerOptions& options = {});
    ~Tracker();
    Tracker(Tracker&&) noexcept;
    Tracker& operator=(Tracker&&) noexcept;

    /// A measured distance between two landmarks (a scale bar), any number of them. Throws std::invalid_argument for
    /// numbers that mean nothing.
    void add_length(int a, int b, double length_m, double sigma_m);
    /// A reading of a range finder, camera to landmark, or to the target's origin (kOrigin; the option range_to_origin
    /// must be on): used with the next view, or not believed. docs/range.md. Throws as above.
    void add_range(std::int64_t stamp_ns, double range_m, double sigma_m, int landmark);
    /// The camera's attitude in a world-aligned frame, for motion::Kind::world: used with a view taken within 0.1 s.
    /// Throws as above.
    void add_attitude(std::int64_t stamp_ns, const Mat33& R_world_camera, double sigma_rad);
    /// Where the target is thought to be, before it was found or after it was lost: the search starts there. Throws as
    /// above.
    void add_pose(std::int64_t stamp_ns, const SE3& T_camera_target, const Mat66& covariance);
    static constexpr int kOrigin = fairlead::kOrigin;

    /// The pose of the target in the view taken at stamp_ns. Bad data end in the status, never in an exception.
    Estimate update(std::int64_t stamp_ns, std::span<const Observation> observations) noexcept;

    /// Where the target will be at stamp_ns, from the views so far: the last pose carried on at its rate, status
    /// coasting, docs/estimator.md eq. (20). Changes nothing. Not ok where nothing is tracked, the stamp is before the
    /// last view's, or further ahead than coast_limit_s.
    [[nodiscard]] Estimate predict(std::int64_t stamp_ns) const noexcept;

    [[nodiscard]] std::span<const Vec3> landmarks() const noexcept;  ///< current model [m]
    [[nodiscard]] MatX landmark_covariance() const;                  ///< 3N x 3N [m^2]
    [[nodiscard]] double noise_factor() const noexcept;              ///< of the told pixel covariances, estimated [-]
    [[nodiscard]] double prior_factor() const noexcept;              ///< of the told model covariance, estimated [-]
    /// What no image can tell of the model, as known before the first view and now; docs/range.md.
    [[nodiscard]] window::GaugeSigma gauge_sigma_told() const;
    [[nodiscard]] window::GaugeSigma gauge_sigma() const;
    /// Directions of the model (of 3N) that the data determine.
    [[nodiscard]] double determined_directions() const noexcept;
    /// What a view from this pose would add to what is known of the model [nats].
    [[nodiscard]] double predicted_gain(const SE3& T_camera_target, double sigma_px) const;
    /// What the range finder always reads too much, as far as known; the option range_bias_sigma_m must be on.
    [[nodiscard]] RangeBias range_bias() const noexcept;
    [[nodiscard]] int views_in_window() const noexcept;
    [[nodiscard]] int ranges_believed() const noexcept;
    [[nodiscard]] int ranges_refused() const noexcept;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace fairlead
