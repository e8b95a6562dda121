// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/tracker/start_pose.hpp"

namespace fairlead {

/// Two poses that explain the views about equally well (flat or distant targets), followed until the data decide.
/// docs/estimator.md eq. (21).
class Hypotheses {
  public:
    [[nodiscard]] bool active() const noexcept { return active_; }
    void drop() noexcept { active_ = false; }

    /// Starts following the pair if their log odds are below the limit; returns active().
    bool consider(const pnp::PosePair& pair, double log_odds_limit) noexcept;

    /// Refines both on a view and adds up the evidence; ends as soon as one of them wins (active() false, best() the
    /// winner). False: both failed.
    [[nodiscard]] bool update(const Camera& camera, const UncertainModel& model,
                              std::span<const Observation> observations, double noise_factor,
                              const TrackerOptions& options, std::vector<Observation>& scratch) noexcept;

    [[nodiscard]] const pnp::RefineResult& best() const noexcept { return pose_[0]; }
    /// Covariance of the better one that also covers the other: Sigma + p d d^T, d the way to the other, p its
    /// probability.
    [[nodiscard]] Mat66 covariance() const noexcept;

  private:
    bool active_ = false;
    pnp::RefineResult pose_[2];
    double cost_[2] = {0.0, 0.0};
};

}  // namespace fairlead
