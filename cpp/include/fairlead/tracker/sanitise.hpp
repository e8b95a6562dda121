// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/pnp/observation.hpp"

namespace fairlead {

/// Copies the usable observations to out (which must have capacity) and returns how many were dropped: landmark
/// unknown, pixel or covariance not finite, covariance not positive definite, or the landmark was already observed with
/// a smaller covariance.
int sanitise(std::span<const Observation> observations, int landmarks, std::vector<Observation>& out) noexcept;

}  // namespace fairlead
