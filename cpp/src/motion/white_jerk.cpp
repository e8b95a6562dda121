// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/white_jerk.hpp"

#include <cmath>

namespace fairlead::motion {
namespace {

/// The same 3 x 3 for every axis.
StateSquare for_each_axis(const Eigen::Matrix3d& A, int axes) {
    StateSquare all = StateSquare::Zero(3 * axes, 3 * axes);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) all.block(axes * i, axes * j, axes, axes).diagonal().setConstant(A(i, j));
    return all;
}

}  // namespace

StateSquare transition(double dt, int axes) {
    Eigen::Matrix3d Phi;
    Phi << 1.0, dt, 0.5 * dt * dt, 0.0, 1.0, dt, 0.0, 0.0, 1.0;
    return for_each_axis(Phi, axes);
}

StateSquare noise_factor(double dt, double density, int axes) {
    // Of [t^5/20 t^4/8 t^3/6; . t^3/3 t^2/2; . . t], in closed form: no digits are lost however short dt is.
    const double root = density * std::sqrt(dt);
    Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
    L(0, 0) = dt * dt / std::sqrt(20.0);
    L(1, 0) = dt * std::sqrt(20.0) / 8.0;
    L(2, 0) = std::sqrt(20.0) / 6.0;
    L(1, 1) = dt / std::sqrt(48.0);
    L(2, 1) = std::sqrt(48.0) / 12.0;
    L(2, 2) = 1.0 / 3.0;
    return for_each_axis(root * L, axes);
}

}  // namespace fairlead::motion
