// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/estimate.hpp"

#include <algorithm>

namespace fairlead {

const char* to_string(Status status) noexcept {
    switch (status) {
        case Status::acquiring:
            return "acquiring";
        case Status::tracking:
            return "tracking";
        case Status::coasting:
            return "coasting";
        case Status::lost:
            return "lost";
    }
    return "";
}

const char* to_string(Reason reason) noexcept {
    switch (reason) {
        case Reason::none:
            return "";
        case Reason::too_few:
            return "too_few";
        case Reason::degenerate:
            return "degenerate";
        case Reason::no_consensus:
            return "no_consensus";
        case Reason::gated:
            return "gated";
        case Reason::ambiguous:
            return "ambiguous";
        case Reason::stamp:
            return "stamp";
        case Reason::diverged:
            return "diverged";
        case Reason::alarm:
            return "alarm";
        case Reason::contradiction:
            return "contradiction";
    }
    return "";
}

Reason doubt(double noise_factor, double prior_factor, bool contradiction) noexcept {
    if (std::max(noise_factor, prior_factor) > kAlarmFactor) return Reason::alarm;
    return contradiction ? Reason::contradiction : Reason::none;
}

Estimate without_pose(Estimate estimate, Status status, Reason reason) noexcept {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    estimate.status = status;
    estimate.reason = reason;
    estimate.T_camera_target = {Mat33::Constant(nan), Vec3::Constant(nan)};
    estimate.covariance.setConstant(nan);
    return estimate;
}

}  // namespace fairlead
