// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/geometry/types.hpp"
#include "fairlead/tracker/options.hpp"

namespace fairlead {

/// What stands behind the landmarks in X, as the options say: the origin of the told frame, one more landmark that is
/// known exactly; then, set aside, what the range finder always reads too much, as (b, 0, 0) about zero.
void append_entries(const TrackerOptions& options, std::vector<Vec3>& X, MatX& P);
/// How many these are, and how many of them are no landmarks.
[[nodiscard]] int appended_entries(const TrackerOptions& options) noexcept;
[[nodiscard]] int set_aside(const TrackerOptions& options) noexcept;

/// The number of the landmark that a range is to; kOrigin is one more than there are, if it may be.
[[nodiscard]] int range_landmark(int landmark, int landmarks, const TrackerOptions& options);

/// What a range finder always reads too much.
struct RangeBias {
    double bias_m = 0.0;
    double sigma_m = 0.0;
};

/// Of X and its covariance, if it was to be estimated; else none.
[[nodiscard]] RangeBias range_bias(const TrackerOptions& options, std::span<const Vec3> X, const MatX& Sigma) noexcept;

}  // namespace fairlead
