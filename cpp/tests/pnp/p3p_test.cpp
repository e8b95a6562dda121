// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/pnp/p3p.hpp"

#include <limits>
#include <numbers>

#include "check.hpp"

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(p3p_test)

using Three = std::array<Vec3, 3>;
using Four = std::array<SE3, 4>;

double distance(const SE3& a, const SE3& b, double size) { return (a.R - b.R).norm() + (a.t - b.t).norm() / size; }

/// Largest sine between T X and its ray: what a solution must make zero.
double misfit(const SE3& T, const Three& rays, const Three& X) {
    double worst = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 p = T * X[i];
        if (!(p.dot(rays[i]) > 0.0)) return std::numeric_limits<double>::infinity();
        worst = std::max(worst, p.normalized().cross(rays[i].normalized()).norm());
    }
    return worst;
}

/// A triangle of size 1 around the origin, seen from range with the camera turned at random.
void random_task(Random& random, double range, SE3& T, Three& rays, Three& X) {
    T = {random.rotation(), Vec3(0, 0, range) + random.vector<3>(0.1 * range)};
    for (std::size_t i = 0; i < 3; ++i) {
        X[i] = random.vector<3>();
        rays[i] = T * X[i] * random.uniform(0.1, 10.0);  // rays of any length will do
    }
}

BOOST_AUTO_TEST_CASE(symmetric_pyramid_by_hand) {
    // Equilateral triangle of circumradius 1 at depth 2 straight ahead.
    Three X, rays;
    for (std::size_t i = 0; i < 3; ++i) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / 3.0;
        X[i] = Vec3(std::cos(angle), std::sin(angle), 0.0);
        rays[i] = X[i] + Vec3(0, 0, 2);
    }
    Four T;
    const int count = pnp::p3p(rays, X, T);
    BOOST_TEST_REQUIRE(count >= 1);
    double best = 1e9;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        BOOST_CHECK(misfit(T[i], rays, X) < 1e-12);
        best = std::min(best, distance(T[i], SE3{Mat33::Identity(), Vec3(0, 0, 2)}, 1.0));
    }
    BOOST_CHECK(best < 1e-12);
}

BOOST_AUTO_TEST_CASE(isosceles_triangle_seen_along_its_axis_of_symmetry) {
    // Then one of the two forms splits by itself, whichever corner is the apex.
    const Three corners{Vec3(-1, 0.3, 0), Vec3(1, 0.3, 0), Vec3(0, -1.2, 0.4)};
    const SE3 truth{Mat33::Identity(), Vec3(0, 0.2, 5)};
    for (std::size_t apex = 0; apex < 3; ++apex) {
        const Three X{corners[(apex + 1) % 3], corners[(apex + 2) % 3], corners[apex]};
        const Three rays{truth * X[0], truth * X[1], truth * X[2]};
        Four T;
        const int count = pnp::p3p(rays, X, T);
        double best = 1e9;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
            best = std::min(best, distance(T[i], truth, 1.0));
        BOOST_TEST(best < 1e-9);
    }
}

BOOST_AUTO_TEST_CASE(finds_the_true_pose) {
    Random random(1);
    for (const double range : {2.0, 10.0, 1e3, 1e5}) {
        int found = 0, solutions = 0, trials = 0;
        for (int k = 0; k < 5000; ++k) {
            SE3 truth;
            Three rays, X;
            random_task(random, range, truth, rays, X);
            bool in_front = true;
            for (const Vec3& x : X) in_front = in_front && (truth * x).z() > 0.1;
            if (!in_front) continue;
            ++trials;
            Four T;
            const int count = pnp::p3p(rays, X, T);
            BOOST_TEST_REQUIRE(count <= 4);
            double best = 1e9;
            for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
                BOOST_CHECK(misfit(T[i], rays, X) < 1e-6 / range);
                CHECK_NEAR(T[i].R.transpose() * T[i].R, Mat33::Identity(), 1e-13);
                CHECK_NEAR(T[i].R.determinant(), 1.0, 1e-13);
                best = std::min(best, distance(T[i], truth, range));
            }
            // Rounding of the rays is 1e-16; seen from afar a side's angle is 1 / range, its foreshortening that
            // squared.
            found += best < 1e-9 * range ? 1 : 0;
            solutions += count;
        }
        BOOST_TEST_MESSAGE("range " << range << ": true pose in " << found << " of " << trials << ", solutions "
                                    << solutions);
        BOOST_TEST(found >= 0.999 * trials);
    }
}

BOOST_AUTO_TEST_CASE(moving_the_camera_or_the_target_moves_the_answer) {
    Random random(2);
    for (int k = 0; k < 200; ++k) {
        SE3 truth;
        Three rays, X;
        random_task(random, 8.0, truth, rays, X);
        const SE3 A{random.rotation(), Vec3::Zero()}, B{random.rotation(), random.vector<3>(5.0)};
        Three turned, moved;
        for (std::size_t i = 0; i < 3; ++i) {
            turned[i] = A * rays[i];
            moved[i] = B * X[i];
        }
        Four T, T_moved;
        const int count = pnp::p3p(rays, X, T), count_moved = pnp::p3p(turned, moved, T_moved);
        for (std::size_t i = 0; i < static_cast<std::size_t>(std::min(count, count_moved)); ++i) {
            double best = 1e9;
            for (std::size_t j = 0; j < static_cast<std::size_t>(count_moved); ++j)
                best = std::min(best, distance(T_moved[j], A * T[i] * B.inverse(), 1.0));
            BOOST_CHECK_MESSAGE(best < 1e-4, "no counterpart, nearest " << best);
        }
    }
}

BOOST_AUTO_TEST_CASE(degenerate_triples_have_no_answer) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    const Three rays{Vec3(0, 0, 1), Vec3(0.1, 0, 1), Vec3(0, 0.1, 1)}, X{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    Four T;
    BOOST_TEST(pnp::p3p(rays, X, T) > 0);
    BOOST_TEST(pnp::p3p(rays, {Vec3(0, 0, 0), Vec3(1, 2, 3), Vec3(2, 4, 6)}, T) == 0);  // collinear
    BOOST_TEST(pnp::p3p(rays, {Vec3(0, 0, 0), Vec3(1, 1e-12, 0), Vec3(2, 0, 0)}, T) == 0);
    BOOST_TEST(pnp::p3p(rays, {Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(2, 4, 7)}, T) == 0);  // two the same
    BOOST_TEST(pnp::p3p(rays, {Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3)}, T) == 0);
    BOOST_TEST(pnp::p3p({Vec3(0, 0, 1), Vec3(0.1, 0, 1), Vec3(0.2, 0, 1)}, X, T) == 0);  // rays in a plane
    BOOST_TEST(pnp::p3p({rays[0], rays[0], rays[1]}, X, T) == 0);
    BOOST_TEST(pnp::p3p({Vec3::Zero(), rays[0], rays[1]}, X, T) == 0);
    BOOST_TEST(pnp::p3p({Vec3(nan, 0, 1), rays[0], rays[1]}, X, T) == 0);
    BOOST_TEST(pnp::p3p(rays, {Vec3(nan, 0, 0), X[1], X[2]}, T) == 0);
    BOOST_TEST(pnp::p3p(rays, {Vec3(inf, 0, 0), X[1], X[2]}, T) == 0);
    BOOST_TEST(pnp::p3p(rays, {Vec3(1e200, 0, 0), X[1], X[2]}, T) == 0);
}

BOOST_AUTO_TEST_CASE(random_rubbish_never_gives_a_wrong_pose) {
    Random random(3);
    for (int k = 0; k < 20000; ++k) {
        Three rays, X;
        for (std::size_t i = 0; i < 3; ++i) {
            rays[i] = random.vector<3>();
            X[i] = random.vector<3>() * std::pow(10.0, random.uniform(-3, 3));
        }
        Four T;
        const int count = pnp::p3p(rays, X, T);
        const double size = (X[0] - X[1]).norm() + (X[0] - X[2]).norm();
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                const Vec3 p = T[i] * X[j], m = rays[j].normalized();
                BOOST_CHECK(p.dot(m) > 0.0 && p.cross(m).norm() < 1e-5 * size);
            }
        }
    }
}

BOOST_AUTO_TEST_SUITE_END()
