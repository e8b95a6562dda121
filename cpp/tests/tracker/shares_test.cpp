// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/shares.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <functional>
#include <vector>

using namespace fairlead;

namespace {

constexpr double kDegree = 0.017453292519943295;

TrackerOptions alike_by(double time_s, double angle_rad, double log_range) {
    TrackerOptions options;
    options.correlation_time_s = time_s;
    options.correlation_angle_rad = angle_rad;
    options.correlation_log_range = log_range;
    return options;
}

/// A camera on a circle, by azimuth, range and time.
Outlook at(double azimuth, double range, double time_s) {
    const Vec3 centre(range * std::cos(azimuth), range * std::sin(azimuth), 0.0);
    const std::vector<Vec3> X{Vec3(1.0, 2.0, 3.0), Vec3(-1.0, -2.0, -3.0)};
    return outlook(static_cast<std::int64_t>(std::llround(1e9 * time_s)), {Mat33::Identity(), -centre}, X);
}

std::vector<double> shares_of(Shares shares, int views, const std::function<Outlook(int)>& view) {
    std::vector<double> all;
    for (int k = 0; k < views; ++k) {
        all.push_back(shares.of(view(k)));
        shares.take();
    }
    return all;
}

double sum(const std::vector<double>& values) {
    double total = 0.0;
    for (const double value : values) total += value;
    return total;
}

}  // namespace

BOOST_AUTO_TEST_CASE(without_correlation_every_view_counts_whole) {
    for (const double share : shares_of(Shares({}), 5, [](int) { return at(0.0, 1000.0, 0.0); }))
        BOOST_TEST(share == 1.0);
}

BOOST_AUTO_TEST_CASE(what_all_views_say_is_as_uncertain_as_it_claims) {
    // x from views z_k = x / r_k + e_k, cov(e) = rho, weighed by their shares; none of them near another.
    const auto view = [](int k) { return at(0.1 * k, 1000.0 * std::exp(-0.3 * std::sin(0.9 * k)), 0.7 * k); };
    const std::vector<double> shares = shares_of(Shares(alike_by(5.0, 0.2, 0.5)), 12, view);
    for (int n = 1; n <= 12; ++n) {
        double claimed = 0.0, variance = 0.0;
        for (int i = 0; i < n; ++i) {
            const Outlook a = view(i);
            claimed += shares[static_cast<std::size_t>(i)] * std::exp(-2.0 * a.log_range);
            for (int j = 0; j < n; ++j) {
                const Outlook b = view(j);
                const double alike = std::exp(-0.1 * std::abs(i - j) / 0.2 - std::abs(a.log_range - b.log_range) / 0.5 -
                                              0.7 * std::abs(i - j) / 5.0);
                variance += alike * shares[static_cast<std::size_t>(i)] * shares[static_cast<std::size_t>(j)] *
                            std::exp(-a.log_range - b.log_range);
            }
        }
        BOOST_TEST(variance == claimed, boost::test_tools::tolerance(1e-4));  // shares are at least 1e-6
    }
    BOOST_TEST(sum(shares) > 1.5);
}

BOOST_AUTO_TEST_CASE(by_time_alone_it_is_the_mean_of_a_first_order_process_for_any_time) {
    // 10,000 views, far more places than are kept. The first counts whole, so that the next log 2 of tau say nothing.
    const std::vector<double> shares =
        shares_of(Shares(alike_by(2.0, 0.0, 0.0)), 10'000, [](int k) { return at(0.0, 1000.0, 0.04 * k); });
    BOOST_TEST(sum(shares) == 1.0 + (9'999 - 35) * std::tanh(0.04 / 4.0), boost::test_tools::tolerance(0.01));
    const std::vector<double> seldom =
        shares_of(Shares(alike_by(2.0, 0.0, 0.0)), 200, [](int k) { return at(0.0, 1000.0, 1.0 * k); });
    BOOST_TEST(seldom.back() == std::tanh(0.25), boost::test_tools::tolerance(1e-6));
}

BOOST_AUTO_TEST_CASE(a_hover_is_one_view_however_long) {
    const auto shaking = [](int k) {
        return at(0.2 * kDegree * std::sin(17.0 * k), 1000.0 * (1.0 + 0.003 * std::sin(5.3 * k)), 0.04 * k);
    };
    BOOST_TEST(sum(shares_of(Shares(alike_by(0.0, 12.0 * kDegree, 1.5)), 5'000, shaking)) < 1.05);
}

BOOST_AUTO_TEST_CASE(a_view_from_near_says_more_than_those_from_far) {
    // Down to a tenth of the range with errors that all stay: with 1 / range growing, each step says something new.
    const auto closing = [](int k) { return at(0.0, 1000.0 * std::exp(-0.01 * k), 0.04 * k); };
    const auto leaving = [](int k) { return at(0.0, 1000.0 * std::exp(0.01 * k), 0.04 * k); };
    const std::vector<double> nearer = shares_of(Shares(alike_by(0.0, 12.0 * kDegree, 1.5)), 230, closing);
    BOOST_TEST(sum({nearer.end() - 100, nearer.end()}) == 1.0 * (1.0 + 1.5) / (2.0 * 1.5),
               boost::test_tools::tolerance(0.02));
    BOOST_TEST(sum(shares_of(Shares(alike_by(0.0, 12.0 * kDegree, 1.5)), 230, leaving)) < 1.01);
}

BOOST_AUTO_TEST_CASE(the_way_back_adds_nothing) {
    const auto there = [](int k) { return at(0.2 * kDegree * k, 1000.0, 0.04 * k); };
    const auto back = [&](int k) { return there(k < 450 ? k : 899 - k); };
    const double once = sum(shares_of(Shares(alike_by(0.0, 12.0 * kDegree, 0.0)), 450, there));
    const double twice = sum(shares_of(Shares(alike_by(0.0, 12.0 * kDegree, 0.0)), 900, back));
    BOOST_TEST(once == 1.0 + (90.0 / 12.0 - std::log(2.0)) / 2.0, boost::test_tools::tolerance(0.01));
    BOOST_TEST(twice == once, boost::test_tools::tolerance(0.03));
}
