// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "fairlead/geometry/se3.hpp"

namespace fairlead {

enum class Status { acquiring, tracking, coasting, lost };

/// Why an estimate is not what one would wish for; none while all is well.
enum class Reason {
    none,
    too_few,       ///< fewer than four usable landmarks in this view
    degenerate,    ///< the landmarks seen do not fix a pose (collinear, identical, rank deficient)
    no_consensus,  ///< no pose explains enough of the observations
    gated,         ///< the view contradicts the tracked pose and was not believed yet
    ambiguous,     ///< two poses explain the data about equally well; the covariance covers both
    stamp,         ///< the stamp is not later than the last one
    diverged,      ///< the joint solution failed; the last good model was kept
    alarm,         ///< residuals are far larger than the told noise and model error allow
    contradiction  ///< the model had to be corrected by more than what was told of it allows
};

/// Noise or model error five times what was told: reason alarm.
inline constexpr double kAlarmFactor = 25.0;

[[nodiscard]] const char* to_string(Status status) noexcept;
[[nodiscard]] const char* to_string(Reason reason) noexcept;

/// What is known after one view. Not ok: pose and covariance are NaN.
struct Estimate {
    std::int64_t stamp_ns = 0;
    Status status = Status::acquiring;
    Reason reason = Reason::none;
    SE3 T_camera_target;  ///< in the frame of the prior model
    /// Of xi in T Exp(xi), xi = (rho, phi) [m, rad], the model's uncertainty included.
    Mat66 covariance = Mat66::Constant(std::numeric_limits<double>::quiet_NaN());
    int inliers = 0;
    int dropped = 0;  ///< observations that were unusable (NaN, unknown, duplicate, no covariance)
    double reprojection_rms_px = std::numeric_limits<double>::quiet_NaN();  ///< over the inliers
    double information_gained = 0.0;        ///< half the growth of log det of the model's information [nats]
    int resets = 0;                         ///< counts jumps of the pose that are not motion
    std::span<const int> inlier_landmarks;  ///< valid until the next update, or as long as the Refinement

    [[nodiscard]] bool ok() const noexcept { return status == Status::tracking || status == Status::coasting; }
};

/// What a valid pose is to be doubted for: the factors of noise and model, and whether the model contradicts its prior.
[[nodiscard]] Reason doubt(double noise_factor, double prior_factor, bool contradiction) noexcept;

/// The same without pose and covariance: NaN.
[[nodiscard]] Estimate without_pose(Estimate estimate, Status status, Reason reason) noexcept;

}  // namespace fairlead
