// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/geometry/se3.hpp"

#include <numbers>

#include "check.hpp"

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(se3_test)

SE3 random_motion(Random& random) { return {random.rotation(), random.vector<3>(10.0)}; }

BOOST_AUTO_TEST_CASE(composition_by_hand) {
    // T_camera_target: a quarter turn about z, then a shift: p_camera = T p_target.
    const SE3 T{so3::exp(Vec3(0, 0, std::numbers::pi / 2)), Vec3(1, 2, 3)};
    CHECK_NEAR(T * Vec3(1, 0, 0), Vec3(1, 3, 3), 1e-15);
    CHECK_NEAR(T * T * Vec3(1, 0, 0), Vec3(-2, 3, 6), 1e-15);
    CHECK_NEAR(T.inverse() * Vec3(1, 3, 3), Vec3(1, 0, 0), 1e-15);
}

BOOST_AUTO_TEST_CASE(group_laws) {
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        const SE3 a = random_motion(random), b = random_motion(random), c = random_motion(random);
        const Vec3 p = random.vector<3>(10.0);
        CHECK_NEAR((a * b) * p, a * (b * p), 1e-13);
        CHECK_NEAR(((a * b) * c).t, (a * (b * c)).t, 1e-13);
        CHECK_NEAR((a * a.inverse()).t, Vec3::Zero(), 1e-13);
        CHECK_NEAR((a * a.inverse()).R, Mat33::Identity(), 1e-14);
    }
}

BOOST_AUTO_TEST_CASE(exp_of_a_screw_by_hand) {
    // Half a turn about z while moving pi along x: the path is a half circle of radius 1 that ends at (0, 2).
    Vec6 xi;
    xi << std::numbers::pi, 0, 0, 0, 0, std::numbers::pi;
    const SE3 T = SE3::exp(xi);
    CHECK_NEAR(T.t, Vec3(0, 2, 0), 1e-15);
    CHECK_NEAR(T.R, Vec3(-1, -1, 1).asDiagonal().toDenseMatrix(), 1e-15);
}

BOOST_AUTO_TEST_CASE(exp_is_a_one_parameter_group) {
    Random random(2);
    for (int i = 0; i < 200; ++i) {
        const Vec6 xi = random.vector<6>();
        const double a = random.uniform(-2.0, 2.0), b = random.uniform(-2.0, 2.0);
        const SE3 whole = SE3::exp((a + b) * xi), parts = SE3::exp(a * xi) * SE3::exp(b * xi);
        CHECK_NEAR(whole.R, parts.R, 1e-14);
        CHECK_NEAR(whole.t, parts.t, 1e-13);
    }
}

BOOST_AUTO_TEST_CASE(log_inverts_exp) {
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        Vec6 xi = random.vector<6>();
        const double angle = i % 2 == 0 ? std::pow(10.0, random.uniform(-14.0, 0.0))
                                        : std::numbers::pi - std::pow(10.0, random.uniform(-10.0, 0.0));
        xi.tail<3>() *= angle / xi.tail<3>().norm();
        CHECK_NEAR(SE3::exp(xi).log(), xi, 2e-14);
    }
}

BOOST_AUTO_TEST_CASE(perturbation_is_a_motion_of_the_target) {
    Random random(4);
    for (int i = 0; i < 100; ++i) {
        const SE3 T = random_motion(random), G = random_motion(random);
        const Vec6 xi = random.vector<6>(0.5);
        CHECK_NEAR(difference(T, perturb(T, xi)), xi, 1e-13);
        // Moving the camera leaves xi as it is; that is why the gauge of the target is one xi for every pose.
        CHECK_NEAR(difference(G * T, G * perturb(T, xi)), xi, 1e-12);
        // dp/dxi = R [I, -hat(X)] at xi = 0, CONVENTIONS.md eq. (7).
        const Vec3 X = random.vector<3>(10.0);
        Mat36 J;
        J << T.R, -T.R * so3::hat(X);
        CHECK_JACOBIAN([&](const Vec6& x) -> Vec3 { return perturb(T, x) * X; }, Vec6(Vec6::Zero()), J);
    }
}

BOOST_AUTO_TEST_SUITE_END()
