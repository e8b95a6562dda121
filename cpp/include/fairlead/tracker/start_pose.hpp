// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fairlead/pnp/planar.hpp"
#include "fairlead/tracker/estimate.hpp"
#include "fairlead/tracker/options.hpp"

namespace fairlead {

/// The model as a start sees it: landmarks with their own 3x3 covariances.
struct UncertainModel {
    std::span<const Vec3> X;
    std::span<const Mat33> covariance;
};

/// Observations with the model's error added to the noise: S = f S_j + B Sigma_j B^T, B = d pi / d X at T,
/// docs/estimator.md eq. (18).
void inflate(const Camera& camera, const UncertainModel& model, const SE3& T_camera_target, double noise_factor,
             std::span<const Observation> observations, std::vector<Observation>& out) noexcept;

/// Where the target is expected to be, and how surely.
struct Prediction {
    SE3 T_camera_target;
    Mat66 covariance;
};

struct StartPose {
    pnp::PosePair poses;
    bool from_prediction = false;
    Reason reason = Reason::none;  ///< none: poses.best is usable
};

/// The pose from which the joint solution starts: refined from the prediction if that explains the view, else by
/// consensus over the view; whichever costs less. scratch must have capacity for the observations.
[[nodiscard]] StartPose find_start(const Camera& camera, const UncertainModel& model,
                                   std::span<const Observation> observations,
                                   const std::optional<Prediction>& predicted, double noise_factor,
                                   const TrackerOptions& options, std::vector<Observation>& scratch) noexcept;

}  // namespace fairlead
