// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace fairlead::motion {

/// Position, velocity and acceleration of d = 1 or 3 axes, stacked (p, v, a).
inline constexpr int kMaxState = 9;
using State = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxState, 1>;
using StateSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxState, kMaxState>;
/// Coupling of the model with it; products of its transpose are bounded and stay off the heap.
using ModelByState = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Eigen::Dynamic, kMaxState>;

/// (p, v, a) after dt of constant acceleration, docs/motion.md eq. (2).
[[nodiscard]] StateSquare transition(double dt, int axes);

/// Lower Cholesky factor of the covariance that white noise of the jerk with density q [m/s^2.5] adds in dt > 0, eq.
/// (3).
[[nodiscard]] StateSquare noise_factor(double dt, double density, int axes);

}  // namespace fairlead::motion
