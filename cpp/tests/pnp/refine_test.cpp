// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/pnp/refine.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <limits>

#include "pnp/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(refine_test)

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

SE3 disturbed(const SE3& T, Random& random, double angle, double share) {
    const SE3 turned{T.R * so3::exp(random.vector<3>().normalized() * angle), T.t};
    return {turned.R, turned.t + random.vector<3>().normalized() * share * T.t.norm()};
}

pnp::RefineResult refine(const Scene& scene, const SE3& start, const Loss& loss = {}, int iterations = 50) {
    return pnp::refine(start, scene.X, scene.observations, scene.camera, loss, iterations);
}

double cost_at(const Scene& scene, const SE3& T, const Loss& loss) {
    double sum = 0.0;
    for (const Observation& o : scene.observations) {
        Vec2 z;
        BOOST_TEST_REQUIRE(scene.camera.project(T * scene.X[static_cast<std::size_t>(o.landmark)], z));
        const Vec2 r = z - o.z;
        sum += loss.rho(r.dot(o.covariance.inverse() * r));
    }
    return sum;
}

BOOST_AUTO_TEST_CASE(exact_observations_give_the_exact_pose) {
    Random random(1);
    const Mat33 K = (Mat33() << 600, 0, 511.5, 0, 620, 511.5, 0, 0, 1).finished();
    const std::vector<double> bob{-0.2, 0.05, 1e-3, -1e-3, 0.0}, rational{0.3, -0.1, 1e-3, 2e-4, 0.02, 0.5, -0.1, 0.03},
        fisheye{-0.01, 0.02, -0.008, 0.001};
    const std::vector<Camera> cameras{pinhole(), make_camera(CameraModel::plumb_bob, 1024, 1024, K, bob),
                                      make_camera(CameraModel::rational, 1024, 1024, K, rational),
                                      make_camera(CameraModel::equidistant, 1024, 1024, K, fisheye)};
    for (const Camera& camera : cameras) {
        for (const double range : {4.0, 30.0}) {
            for (int i = 0; i < 30; ++i) {
                const Scene scene = make_scene(random, 8, Vec3(1, 1, 1), range, 0.0, camera);
                const pnp::RefineResult result = refine(scene, disturbed(scene.T, random, 0.1, 0.05), Loss{kInf});
                BOOST_TEST(result.ok);
                BOOST_TEST(result.inliers == 8);
                BOOST_TEST(rotation_error(result.T_camera_target, scene.T) < 1e-9);
                BOOST_TEST(position_error(result.T_camera_target, scene.T) < 1e-9);
                BOOST_TEST(result.iterations <= 12);
            }
        }
    }
}

BOOST_AUTO_TEST_CASE(the_answer_is_a_minimum_of_the_cost_it_tells) {
    Random random(2);
    for (int i = 0; i < 50; ++i) {
        Scene scene = make_scene(random, 12, Vec3(1, 1, 1), 8.0, 1.0);
        spoil(scene, random, i % 4);
        const Loss loss{6.0};
        const pnp::RefineResult result = refine(scene, scene.T, loss);
        BOOST_TEST_REQUIRE(result.ok);
        CHECK_NEAR(result.cost, cost_at(scene, result.T_camera_target, loss), 1e-9 * result.cost);
        // Steps in units of the standard deviation: at a minimum the cost is stationary and rises with their square.
        const Mat66 root = result.information.llt().matrixU().toDenseMatrix().inverse();
        for (int k = 0; k < 12; ++k) {
            const Vec6 step = root * (k % 2 == 0 ? 1e-2 : -1e-2) * Vec6::Unit(k / 2);
            const double rise = cost_at(scene, perturb(result.T_camera_target, step), loss) - result.cost;
            BOOST_TEST(rise > 0.0);
            BOOST_TEST(rise < 2e-4);
        }
    }
}

BOOST_AUTO_TEST_CASE(information_is_the_weighted_normal_matrix) {
    Random random(3);
    const Loss loss{6.0};
    Scene scene = make_scene(random, 10, Vec3(1, 1, 1), 8.0, 1.0);
    for (Vec3& X : scene.X) X += Vec3(50, -20, 10);  // an origin far from the landmarks
    scene.T.t -= scene.T.R * Vec3(50, -20, 10);
    spoil(scene, random, 2);
    const pnp::RefineResult result = refine(scene, scene.T, loss);
    BOOST_TEST_REQUIRE(result.ok);
    Mat66 H = Mat66::Zero();
    for (const Observation& o : scene.observations) {
        const Vec3& X = scene.X[static_cast<std::size_t>(o.landmark)];
        const auto f = [&](const Vec6& xi) {
            Vec2 z;
            BOOST_TEST_REQUIRE(scene.camera.project(perturb(result.T_camera_target, xi) * X, z));
            return z;
        };
        Vec2 z;
        Mat23 J_point;
        BOOST_TEST_REQUIRE(scene.camera.project(result.T_camera_target * X, z, J_point));
        Mat36 motion;
        motion << result.T_camera_target.R, -result.T_camera_target.R * so3::hat(X);
        const Mat26 J = J_point * motion;
        CHECK_JACOBIAN(f, Vec6(Vec6::Zero()), J);
        const Mat22 W = o.covariance.inverse();
        H += loss.weight((z - o.z).dot(W * (z - o.z))) * J.transpose() * W * J;
    }
    CHECK_NEAR(result.information, H, 1e-9 * H.norm());
}

BOOST_AUTO_TEST_CASE(covariance_is_honest) {
    Random random(4);
    const int trials = 400;
    double sum = 0.0;
    for (int i = 0; i < trials; ++i) {
        const Scene scene = make_scene(random, 10, Vec3(1, 1, 1), 8.0, 1.0);
        const pnp::RefineResult result = refine(scene, scene.T, Loss{kInf});
        BOOST_TEST_REQUIRE(result.ok);
        const Vec6 xi = difference(result.T_camera_target, scene.T);
        sum += xi.dot(result.information * xi);
    }
    // Mean of chi-square with 6 degrees of freedom; 99.9 % band of 400 trials is 3.29 sqrt(12 / 400).
    BOOST_TEST_MESSAGE("mean NEES " << sum / trials << " of 6");
    BOOST_TEST(std::abs(sum / trials - 6.0) < 0.57);
}

BOOST_AUTO_TEST_CASE(moving_the_target_moves_the_answer) {
    Random random(5);
    for (const double distance : {1.0, 1e3, 1e6}) {
        Scene scene = make_scene(random, 9, Vec3(1, 1, 1), 8.0, 1.0);
        const SE3 start = disturbed(scene.T, random, 0.1, 0.02);
        const pnp::RefineResult here = refine(scene, start);
        const SE3 G{random.rotation(), random.vector<3>(distance)};
        for (Vec3& X : scene.X) X = G * X;
        std::reverse(scene.observations.begin(), scene.observations.end());
        const pnp::RefineResult there = refine(scene, start * G.inverse());
        BOOST_TEST(here.ok);
        BOOST_TEST(there.ok);
        const SE3 back = there.T_camera_target * G;
        CHECK_NEAR(back.R, here.T_camera_target.R, 1e-7);
        CHECK_NEAR(back.t, here.T_camera_target.t, 1e-6 + 1e-13 * distance);
        BOOST_TEST(std::abs(there.cost - here.cost) < 1e-6 * here.cost);
    }
}

BOOST_AUTO_TEST_CASE(outliers_do_not_pull) {
    Random random(6);
    double worst = 0.0;
    for (int i = 0; i < 100; ++i) {
        Scene scene = make_scene(random, 20, Vec3(1, 1, 1), 8.0, 0.5);
        spoil(scene, random, 6);
        const pnp::RefineResult result = refine(scene, disturbed(scene.T, random, 0.01, 0.002));
        BOOST_TEST(result.ok);
        BOOST_TEST(result.inliers >= 12);
        worst = std::max(worst, rotation_error(result.T_camera_target, scene.T));
    }
    BOOST_TEST(worst < 0.01);  // 20 landmarks at 240 px radius, 0.5 px: sigma is about 1.5e-3 rad
}

BOOST_AUTO_TEST_CASE(far_starts_mostly_converge) {
    Random random(7);
    int converged = 0;
    for (int i = 0; i < 200; ++i) {
        const Scene scene = make_scene(random, 10, Vec3(1, 1, 1), 6.0, 0.0);
        const pnp::RefineResult result = refine(scene, disturbed(scene.T, random, 0.5, 0.3), Loss{kInf}, 100);
        converged += result.ok && rotation_error(result.T_camera_target, scene.T) < 1e-6 ? 1 : 0;
        if (result.ok) BOOST_TEST(result.T_camera_target.t.z() > 0.0);
    }
    BOOST_TEST_MESSAGE("from 30 degrees and 30 % of range: " << converged << " of 200");
    BOOST_TEST(converged >= 190);
}

BOOST_AUTO_TEST_CASE(never_ok_behind_the_camera) {
    Random random(8);
    for (int i = 0; i < 100; ++i) {
        const Scene scene = make_scene(random, 8, Vec3(1, 1, 1), 6.0, 1.0);
        for (const Loss& loss : {Loss{}, Loss{kInf}}) {
            // The mirror image through the camera centre projects onto the same pixels but lies behind.
            const SE3 behind{Vec3(-1, -1, 1).asDiagonal() * scene.T.R,
                             Vec3(-scene.T.t.x(), -scene.T.t.y(), -scene.T.t.z())};
            for (const SE3& start : {behind, SE3{scene.T.R, -scene.T.t}, SE3{scene.T.R, Vec3::Zero()}}) {
                const pnp::RefineResult result = refine(scene, start, loss);
                if (!result.ok) continue;
                BOOST_TEST(result.T_camera_target.t.z() > 0.0);
                BOOST_CHECK(is_finite(result));
            }
        }
    }
}

BOOST_AUTO_TEST_CASE(broken_observations_are_left_out) {
    Random random(9);
    Scene scene = make_scene(random, 8, Vec3(1, 1, 1), 6.0, 1.0);
    const pnp::RefineResult clean = refine(scene, scene.T);
    const Observation good = scene.observations.front();
    const auto add = [&](auto change) {
        Observation o = good;
        change(o);
        scene.observations.push_back(o);
    };
    add([](Observation& o) { o.z.x() = kNaN; });
    add([](Observation& o) { o.z.y() = kInf; });
    add([](Observation& o) { o.covariance(0, 0) = kNaN; });
    add([](Observation& o) { o.covariance(1, 1) = kInf; });
    add([](Observation& o) { o.covariance.setZero(); });
    add([](Observation& o) { o.covariance = -Mat22::Identity(); });
    add([](Observation& o) { o.covariance << 1, 2, 2, 1; });
    add([](Observation& o) { o.landmark = -1; });
    add([](Observation& o) { o.landmark = 8; });
    const pnp::RefineResult result = refine(scene, scene.T);
    BOOST_TEST(result.ok);
    CHECK_NEAR(result.T_camera_target.t, clean.T_camera_target.t, 0.0);
    CHECK_NEAR(result.information, clean.information, 0.0);
}

BOOST_AUTO_TEST_CASE(degenerate_tasks_are_not_ok) {
    Random random(10);
    const Scene scene = make_scene(random, 8, Vec3(1, 1, 1), 6.0, 0.0);
    const auto with = [&](auto place) {
        Scene changed = scene;
        for (std::size_t j = 0; j < changed.X.size(); ++j) {
            changed.X[j] = place(static_cast<double>(j));
            (void)changed.camera.project(changed.T * changed.X[j], changed.observations[j].z);
        }
        return refine(changed, changed.T);
    };
    BOOST_TEST(!with([](double j) { return Vec3(0.1 * j, 0.2 * j, -0.1 * j); }).ok);   // collinear
    BOOST_TEST(!with([](double) { return Vec3(0.1, 0.2, 0.3); }).ok);                  // identical
    BOOST_TEST(!with([](double j) { return Vec3(j > 3 ? 0.5 : 0.0, 0.2, 0.3); }).ok);  // two places
    BOOST_TEST(!with([](double j) { return Vec3(kNaN, j, 0.0); }).ok);
    BOOST_TEST(!with([](double j) { return Vec3(1e200 * j, 1e200, -1e200 * j * j); }).ok);
    BOOST_TEST(!with([](double j) { return Vec3(1e308 * j, 1e308, -1e308 * j * j); }).ok);
    Scene few = scene;
    few.observations.resize(2);
    BOOST_TEST(!refine(few, few.T).ok);
    few.observations.clear();
    BOOST_TEST(!refine(few, few.T).ok);
    BOOST_TEST(!refine(scene, {Mat33::Constant(kNaN), scene.T.t}).ok);
    BOOST_TEST(!refine(scene, {scene.T.R, Vec3(0, 0, kInf)}).ok);
    BOOST_TEST(!refine(scene, {scene.T.R, Vec3(1e200, 0, 1e200)}).ok);
}

BOOST_AUTO_TEST_CASE(flat_and_distant_targets_are_not_called_degenerate) {
    Random random(11);
    for (const double range : {1e2, 1e4}) {
        Scene scene = make_scene(random, 8, Vec3(1, 1, 0), range, 0.0);
        scene.T.R = so3::exp(Vec3(0.5, 0.2, 0.1));
        for (Observation& o : scene.observations)
            BOOST_TEST_REQUIRE(scene.camera.project(scene.T * scene.X[static_cast<std::size_t>(o.landmark)], o.z));
        BOOST_TEST(refine(scene, scene.T).ok);
    }
}

BOOST_AUTO_TEST_SUITE_END()
