// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/robust/loss.hpp"

#include <limits>
#include <stdexcept>

#include "check.hpp"

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(loss_test)

using Scalar = Eigen::Matrix<double, 1, 1>;

BOOST_AUTO_TEST_CASE(by_hand) {
    const Loss loss{4.0};
    CHECK_NEAR(loss.rho(0.0), 0.0, 0.0);
    CHECK_NEAR(loss.rho(3.0), 3.0, 0.0);
    CHECK_NEAR(loss.rho(4.0), 4.0, 0.0);
    CHECK_NEAR(loss.rho(8.0), 6.0, 0.0);  // 4 (2 - 4 / 8)
    CHECK_NEAR(loss.weight(3.0), 1.0, 0.0);
    CHECK_NEAR(loss.weight(8.0), 0.25, 0.0);  // (4 / 8)^2
    CHECK_NEAR(loss.rho(1e300), loss.bound(), 1e-12);
    CHECK_NEAR(loss.rho(std::numeric_limits<double>::infinity()), 8.0, 0.0);
}

BOOST_AUTO_TEST_CASE(weight_is_the_derivative) {
    for (const double threshold : {0.5, 5.99, 9.21034037197618, 100.0}) {
        const Loss loss{threshold};
        for (double s = 0.013; s < 1e4; s *= 1.7) {
            const auto f = [&](const Scalar& x) { return Scalar(loss.rho(x[0])); };
            CHECK_JACOBIAN(f, Scalar(s), Scalar(loss.weight(s)));
        }
        // Continuous with its first derivative at the threshold.
        CHECK_NEAR(loss.rho(threshold * (1 + 1e-9)), threshold, 1e-8 * threshold);
        CHECK_NEAR(loss.weight(threshold * (1 + 1e-9)), 1.0, 1e-8);
    }
}

BOOST_AUTO_TEST_CASE(concave_bounded_and_redescending) {
    const Loss loss{3.0};
    double last_rho = 0.0, last_weight = 1.0;
    for (double s = 0.1; s < 1e6; s *= 1.3) {
        BOOST_CHECK(loss.rho(s) > last_rho && loss.rho(s) < loss.bound());
        BOOST_CHECK(loss.weight(s) <= last_weight && loss.weight(s) > 0.0);
        // The tangent lies above the loss: what makes the weighted quadratic a majorant.
        for (double t = 0.1; t < 1e6; t *= 7.0)
            BOOST_CHECK(loss.rho(t) <= loss.rho(s) + loss.weight(s) * (t - s) + 1e-12 * t);
        last_rho = loss.rho(s);
        last_weight = loss.weight(s);
    }
}

BOOST_AUTO_TEST_CASE(infinity_is_least_squares) {
    const Loss loss{std::numeric_limits<double>::infinity()};
    for (const double s : {0.0, 1.0, 1e9}) {
        CHECK_NEAR(loss.rho(s), s, 0.0);
        CHECK_NEAR(loss.weight(s), 1.0, 0.0);
    }
    BOOST_CHECK_NO_THROW(validate(loss));
}

BOOST_AUTO_TEST_CASE(unusable_thresholds_are_refused) {
    for (const double threshold : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        bool refused = false;
        try {
            validate(Loss{threshold});
        } catch (const std::invalid_argument&) {
            refused = true;
        }
        BOOST_CHECK(refused);
    }
}

BOOST_AUTO_TEST_SUITE_END()
