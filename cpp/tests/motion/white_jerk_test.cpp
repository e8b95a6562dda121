// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/white_jerk.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>

using namespace fairlead;

BOOST_AUTO_TEST_CASE(two_steps_are_one_of_their_sum) {
    for (const int axes : {1, 3}) {
        const double a = 0.04, b = 1.7, q = 0.5;
        const motion::StateSquare Phi = motion::transition(b, axes);
        BOOST_TEST((Phi * motion::transition(a, axes) - motion::transition(a + b, axes)).norm() < 1e-12);
        const auto Q = [&](double dt) -> motion::StateSquare {
            const motion::StateSquare L = motion::noise_factor(dt, q, axes);
            return L * L.transpose();
        };
        const motion::StateSquare once = Q(a + b);
        const motion::StateSquare twice = Phi * Q(a) * Phi.transpose() + Q(b);
        BOOST_TEST((once - twice).norm() < 1e-12 * once.norm());
    }
}

BOOST_AUTO_TEST_CASE(noise_is_the_integral_of_white_jerk) {
    const double dt = 0.6, q = 0.5;
    Eigen::Matrix3d integral = Eigen::Matrix3d::Zero();
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
        const double left = dt * (i + 0.5) / kSteps;
        const Eigen::Vector3d effect(0.5 * left * left, left, 1.0);
        integral += q * q * effect * effect.transpose() * dt / kSteps;
    }
    const motion::StateSquare L = motion::noise_factor(dt, q, 1);
    BOOST_TEST((L * L.transpose() - integral).norm() < 1e-7 * integral.norm());
}
