// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/options.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace fairlead {
namespace {

void require(bool good, const char* name, double value, const char* expected) {
    if (!good)
        throw std::invalid_argument(std::string(name) + ": got " + std::to_string(value) + ", expected " + expected);
}

}  // namespace

void validate(const TrackerOptions& options) {
    require(options.max_views >= 2 && options.max_views <= 4096, "max_views", options.max_views, "2 to 4096");
    require(options.loss_threshold > 0.0, "loss_threshold", options.loss_threshold, "a positive number");
    require(options.gate > 0.0, "gate", options.gate, "a positive number");
    require(options.min_inlier_ratio > 0.0 && options.min_inlier_ratio <= 1.0, "min_inlier_ratio",
            options.min_inlier_ratio, "more than 0 and at most 1");
    require(options.coast_limit_s >= 0.0 && std::isfinite(options.coast_limit_s), "coast_limit_s",
            options.coast_limit_s, "zero or more seconds");
    require(options.max_step_rad > 0.0, "max_step_rad", options.max_step_rad, "a positive angle");
    require(options.confirmations >= 1, "confirmations", options.confirmations, "at least 1");
    require(options.jerk_density_m_s25 > 0.0 && std::isfinite(options.jerk_density_m_s25), "jerk_density_m_s25",
            options.jerk_density_m_s25, "a positive number");
    require(options.correlation_time_s >= 0.0 && std::isfinite(options.correlation_time_s), "correlation_time_s",
            options.correlation_time_s, "zero or more seconds");
    require(options.correlation_angle_rad >= 0.0 && std::isfinite(options.correlation_angle_rad),
            "correlation_angle_rad", options.correlation_angle_rad, "zero or more");
    require(options.correlation_log_range >= 0.0 && std::isfinite(options.correlation_log_range),
            "correlation_log_range", options.correlation_log_range, "zero or more");
    require(options.design_effect >= 1.0 && std::isfinite(options.design_effect), "design_effect",
            options.design_effect, "one or more");
    require(options.range_bias_sigma_m >= 0.0 && std::isfinite(options.range_bias_sigma_m), "range_bias_sigma_m",
            options.range_bias_sigma_m, "zero or more metres");
    require(options.ambiguity_log_odds >= 0.0, "ambiguity_log_odds", options.ambiguity_log_odds, "zero or more");
}

}  // namespace fairlead
