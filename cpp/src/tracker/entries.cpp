// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/entries.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "fairlead/tracker/readings.hpp"

namespace fairlead {

void append_entries(const TrackerOptions& options, std::vector<Vec3>& X, MatX& P) {
    const int appended = appended_entries(options);
    X.insert(X.end(), static_cast<std::size_t>(appended), Vec3::Zero());
    const MatX told = P;
    P = MatX::Zero(told.rows() + 3 * appended, told.cols() + 3 * appended);
    P.topLeftCorner(told.rows(), told.cols()) = told;
    P.diagonal().tail(3 * set_aside(options)).setConstant(options.range_bias_sigma_m * options.range_bias_sigma_m);
}

int appended_entries(const TrackerOptions& options) noexcept {
    return (options.range_to_origin ? 1 : 0) + set_aside(options);
}

int set_aside(const TrackerOptions& options) noexcept { return options.range_bias_sigma_m > 0.0 ? 1 : 0; }

int range_landmark(int landmark, int landmarks, const TrackerOptions& options) {
    require((landmark == kOrigin && options.range_to_origin) || (landmark >= 0 && landmark < landmarks), "range to",
            std::to_string(landmark), "a landmark, or the origin with the option range_to_origin");
    return landmark == kOrigin ? landmarks : landmark;
}

RangeBias range_bias(const TrackerOptions& options, std::span<const Vec3> X, const MatX& Sigma) noexcept {
    if (set_aside(options) == 0) return {};
    const Eigen::Index row = Sigma.rows() - 3;
    return {X.back().x(), std::sqrt(std::max(0.0, Sigma(row, row)))};
}

}  // namespace fairlead
