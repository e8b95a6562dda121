// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "fairlead/motion/tie.hpp"

namespace fairlead {

/// In the place of a landmark's number: the target's origin.
inline constexpr int kOrigin = -1;

struct TrackerOptions {
    int max_views =
        256;  ///< keyframes kept and relinearised; more cost time, fewer lose accuracy while the model is poor
    double loss_threshold =
        9.21034037197618;  ///< [-] squared whitened residual where the robust loss turns; chi-square, 2 dof, 99 %
    double gate =
        18.420680743952367;  ///< [-] squared whitened innovation beyond which an observation is an outlier; 99.99 %
    double min_inlier_ratio = 0.4;             ///< [-] fewer inliers than this share of the observations is no pose
    double coast_limit_s = 0.5;                ///< [s] without a fresh pose until the estimate is no longer valid
    double max_step_rad = 1.5707963267948966;  ///< [rad] a larger turn between two views needs evidence
    int confirmations = 3;                     ///< views that must agree before such a step is believed
    double ambiguity_log_odds = 4.5;           ///< [nats] two poses closer than this are both kept
    motion::Kind motion = motion::Kind::none;  ///< what is smooth, docs/motion.md
    double jerk_density_m_s25 = 0.5;           ///< [m/s^2.5] of its white jerk; told, then judged by the data
    double correlation_time_s = 0.0;     ///< [s] over which detections err alike, so that many views say what one does
    double correlation_angle_rad = 0.0;  ///< [rad] the same by the turn of the line of sight in the target frame
    double correlation_log_range = 0.0;  ///< [-] the same by the logarithm of the range; 0 of each: makes no difference
    double design_effect = 1.0;          ///< [-] by which errors that its landmarks share widen a view's pose
    bool range_to_origin = false;        ///< readings of the range to the target's origin will come
    double range_bias_sigma_m = 0.0;     ///< [m] what the range finder may always read too much, one sigma; 0: nothing
    std::uint64_t seed = 0;              ///< of the consensus search
};

/// Throws std::invalid_argument naming the option, what came and what was expected.
void validate(const TrackerOptions& options);

}  // namespace fairlead
