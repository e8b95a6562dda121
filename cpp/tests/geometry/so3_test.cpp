// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/geometry/so3.hpp"

#include <Eigen/LU>
#include <numbers>

#include "check.hpp"

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(so3_test)

constexpr double kPi = std::numbers::pi;

BOOST_AUTO_TEST_CASE(hat_is_the_cross_product) {
    const Vec3 a(1.0, 2.0, 3.0), b(-4.0, 5.0, 0.5);
    CHECK_NEAR(so3::hat(a) * b, Vec3(2.0 * 0.5 - 3.0 * 5.0, 3.0 * -4.0 - 1.0 * 0.5, 1.0 * 5.0 - 2.0 * -4.0), 0.0);
}

BOOST_AUTO_TEST_CASE(exp_by_hand) {
    Mat33 quarter;
    quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    CHECK_NEAR(so3::exp(Vec3(0, 0, kPi / 2)), quarter, 1e-15);
    CHECK_NEAR(so3::exp(Vec3::Zero()), Mat33::Identity(), 0.0);
    CHECK_NEAR(so3::exp(Vec3(kPi, 0, 0)), Vec3(1, -1, -1).asDiagonal().toDenseMatrix(), 1e-15);
}

/// Scaling and squaring of the power series: shares no formula with Rodrigues'.
Mat33 exp_by_squaring(const Vec3& phi) {
    const Mat33 A = so3::hat(phi) / 1024.0;
    Mat33 sum = Mat33::Identity(), term = Mat33::Identity();
    for (int k = 1; k < 12; ++k) sum += term = term * A / k;
    for (int k = 0; k < 10; ++k) sum = sum * sum;
    return sum;
}

BOOST_AUTO_TEST_CASE(exp_is_the_matrix_exponential) {
    Random random(1);
    for (int i = 0; i < 500; ++i) {
        const Vec3 phi = random.vector<3>().normalized() * std::pow(10.0, random.uniform(-12.0, 0.6));
        CHECK_NEAR(so3::exp(phi), exp_by_squaring(phi), 1e-12);
        const Mat33 R = so3::exp(phi);
        CHECK_NEAR(R.transpose() * R, Mat33::Identity(), 4e-15);
        CHECK_NEAR(R.determinant(), 1.0, 4e-15);
    }
}

BOOST_AUTO_TEST_CASE(log_inverts_exp) {
    Random random(2);
    for (int i = 0; i < 500; ++i) {
        const double angle =
            i % 2 == 0 ? std::pow(10.0, random.uniform(-15.0, 0.0)) : kPi - std::pow(10.0, random.uniform(-12.0, 0.0));
        const Vec3 phi = random.vector<3>().normalized() * angle;
        CHECK_NEAR(so3::log(so3::exp(phi)), phi, 4e-15 + 4e-15 * angle);
    }
    for (int i = 0; i < 500; ++i) {
        const Mat33 R = random.rotation();
        BOOST_CHECK(so3::log(R).norm() <= kPi + 1e-15);
        CHECK_NEAR(so3::exp(so3::log(R)), R, 1e-14);
    }
}

BOOST_AUTO_TEST_CASE(log_at_half_a_turn) {
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 1, 1), Vec3(-1, 2, 0)}) {
        const Mat33 R = so3::exp(kPi * axis.normalized());
        CHECK_NEAR(so3::log(R).norm(), kPi, 1e-14);
        CHECK_NEAR(so3::exp(so3::log(R)), R, 1e-14);
    }
}

BOOST_AUTO_TEST_CASE(left_jacobian_is_the_integral) {
    Random random(3);
    for (int i = 0; i < 50; ++i) {
        const Vec3 phi = random.vector<3>().normalized() * std::pow(10.0, random.uniform(-6.0, 0.5));
        Mat33 integral = Mat33::Zero();  // Gauss-Legendre, 3 points on 200 intervals: error far below rounding
        for (int k = 0; k < 200; ++k) {
            const double centre = (k + 0.5) / 200.0, offset = std::sqrt(0.6) / 400.0;
            integral += (5.0 * so3::exp((centre - offset) * phi) + 8.0 * so3::exp(centre * phi) +
                         5.0 * so3::exp((centre + offset) * phi)) /
                        (18.0 * 200.0);
        }
        CHECK_NEAR(so3::left_jacobian(phi), integral, 1e-13);
    }
}

BOOST_AUTO_TEST_CASE(left_jacobian_is_continuous_where_its_series_ends) {
    const Vec3 axis = Vec3(1, -2, 0.5).normalized();
    CHECK_NEAR(so3::left_jacobian((0.5 - 1e-14) * axis), so3::left_jacobian((0.5 + 1e-14) * axis), 1e-14);
}

BOOST_AUTO_TEST_CASE(nearest_rotation) {
    Random random(4);
    for (int i = 0; i < 100; ++i) {
        const Mat33 R = random.rotation();
        CHECK_NEAR(so3::nearest(R), R, 1e-14);
        CHECK_NEAR(so3::nearest(3.0 * R), R, 1e-14);
        Mat33 M = R;
        for (int k = 0; k < 3; ++k) M.col(k) += random.vector<3>(0.2);
        const Mat33 best = so3::nearest(M);
        CHECK_NEAR(best.transpose() * best, Mat33::Identity(), 1e-14);
        CHECK_NEAR(best.determinant(), 1.0, 1e-14);
        for (int k = 0; k < 20; ++k) {
            const Mat33 other = best * so3::exp(random.vector<3>(0.1));
            BOOST_CHECK((other - M).norm() >= (best - M).norm());
        }
    }
    CHECK_NEAR(so3::nearest(-Mat33::Identity()).determinant(), 1.0, 1e-14);
}

BOOST_AUTO_TEST_SUITE_END()
