// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/pnp/observation.hpp"

namespace fairlead {

/// How many consensus sets as large as this one chance would offer if the observations lay anywhere in the image (a
/// contrario, Moisan and Stival 2004, eq. (7)): 4 C(n, 3) P[Binomial(n - 3, p) >= m - 3], docs/estimator.md eq. (19). p
/// is the mean share of the image that an observation's region s <= gate covers, covariances as in `inflated`. Near 1
/// or above: the agreement means nothing.
[[nodiscard]] double chance_consensus(const Camera& camera, std::span<const Observation> inflated, int inliers,
                                      double gate) noexcept;

}  // namespace fairlead
