// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "fairlead/pnp/observation.hpp"
#include "fairlead/tracker/estimate.hpp"
#include "fairlead/tracker/options.hpp"

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

    /// The pose of the target in the view taken at stamp_ns. Bad data end in the status, never in an exception.
    Estimate update(std::int64_t stamp_ns, std::span<const Observation> observations) noexcept;

    [[nodiscard]] std::span<const Vec3> landmarks() const noexcept;  ///< current model [m]
    [[nodiscard]] MatX landmark_covariance() const;                  ///< 3N x 3N [m^2]
    [[nodiscard]] double noise_factor() const noexcept;              ///< of the told pixel covariances, estimated [-]
    [[nodiscard]] double prior_factor() const noexcept;              ///< of the told model covariance, estimated [-]
    [[nodiscard]] int views_in_window() const noexcept;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace fairlead
