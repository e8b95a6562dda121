// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/tracker/start_pose.hpp"

namespace fairlead {

/// Covariance of a pose that also covers another one, which explains the data by `nats` less well: Sigma + p d d^T, d
/// the way to the other, p its probability. docs/estimator.md eq. (21).
[[nodiscard]] Mat66 mixed(const Mat66& covariance, const SE3& T, const SE3& other, double nats) noexcept;

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
    /// Of the better one, mixed with the other.
    [[nodiscard]] Mat66 covariance() const noexcept;

  private:
    bool active_ = false;
    pnp::RefineResult pose_[2];
    double sum_[2] = {0.0, 0.0};   ///< of the costs of all views
    double cost_[2] = {0.0, 0.0};  ///< of as many views as say something new
    double common_ = 0.0;          ///< sum of the shares that each view after the first has in common with the others
};

}  // namespace fairlead
