// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/density.hpp"

#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>

using namespace fairlead;

namespace {

/// Density found for a swing of this many metres in ten seconds, seen with 5 m of noise.
double density_of_swing(double amplitude, double told, int axes) {
    motion::DensityBank bank(told, axes);
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal(0.0, 5.0);
    for (int k = 0; k < 500; ++k) {
        const double p = amplitude * std::sin(2.0 * 3.14159 * 0.04 * k / 10.0);
        const double x = normal(random), y = normal(random), z = normal(random);
        bank.observe(0.04, Vec3(1000.0 + p + x, p + y, z), 25.0 * Mat33::Identity());
    }
    return bank.density();
}

}  // namespace

BOOST_AUTO_TEST_CASE(the_rougher_the_path_the_higher_the_density_whatever_was_told) {
    for (const int axes : {1, 3}) {
        for (const double told : {0.05, 0.5, 5.0}) {
            const double still = density_of_swing(0.0, told, axes);
            const double rough = density_of_swing(90.0, told, axes);
            BOOST_TEST(still < 4.0 * told);
            BOOST_TEST(rough > 4.0);  // a swing of 90 m in 10 s has a jerk of 22 m/s^3
            BOOST_TEST(rough < 4000.0);
        }
    }
}
