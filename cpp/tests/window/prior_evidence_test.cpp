// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/prior_evidence.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <random>

using namespace fairlead;

namespace {

constexpr int kLandmarks = 20;

/// Factors for data that see every coordinate with the same deviation, of a model that is `truth` deviations off.
window::PriorFactors judge(double data_sigma, double truth, std::uint64_t seed) {
    const int n = 3 * kLandmarks;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    window::LandmarkPrior prior{VecX::Zero(n), MatX::Identity(n, n), VecX::Zero(n)};
    const MatX A = MatX::Identity(n, n) / (data_sigma * data_sigma);
    const VecX x = VecX::NullaryExpr(n, [&] { return truth * normal(random) + data_sigma * normal(random); });
    return window::PriorEvidence(kLandmarks).evaluate(prior, A, A * x);
}

}  // namespace

BOOST_AUTO_TEST_CASE(good_data_find_the_factor) {
    for (const double truth : {0.5, 1.0, 3.0}) {
        double likely = 0.0;
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            const window::PriorFactors found = judge(0.01, truth, seed);
            BOOST_TEST(found.believed <= found.likely);
            BOOST_TEST(found.believed > 0.4 * truth * truth);
            likely += found.likely / 40.0;
        }
        const double expected = (10.0 + 60.0 * truth * truth) / 70.0;  // belief of ten degrees of freedom in 1
        BOOST_TEST(std::abs(likely / expected - 1.0) < 0.1);
    }
}

BOOST_AUTO_TEST_CASE(data_that_say_nothing_leave_the_told_factor_likely_and_the_smallest_believed) {
    const window::PriorFactors found = judge(100.0, 1.0, 1);
    BOOST_TEST(std::abs(found.likely - 1.0) < 0.05);
    BOOST_TEST(std::abs(found.believed - 1.0 / 9.0) < 1e-9);
}

BOOST_AUTO_TEST_CASE(numbers_that_are_not_finite_change_nothing) {
    const int n = 3 * kLandmarks;
    const window::LandmarkPrior prior{VecX::Zero(n), MatX::Identity(n, n), VecX::Zero(n)};
    const window::PriorFactors found =
        window::PriorEvidence(kLandmarks).evaluate(prior, MatX::Constant(n, n, std::nan("")), VecX::Zero(n));
    BOOST_TEST(found.likely == 1.0);
    BOOST_TEST(found.believed == 1.0);
}
