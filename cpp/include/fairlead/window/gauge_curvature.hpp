// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/geometry/types.hpp"

namespace fairlead::window {

/// Adds to the covariance of the landmarks what a Gaussian in X leaves out: rotation and scale of the model are known
/// much worse than its shape, and a rotation by theta moves a landmark at d by theta x d + 1/2 theta x (theta x d) and
/// turns the error of the shape. To second order, docs/estimator.md eq. (22)-(24). For what is reported; the solution
/// itself does not need it.
void add_gauge_curvature(std::span<const Vec3> X, MatX& Sigma);

}  // namespace fairlead::window
