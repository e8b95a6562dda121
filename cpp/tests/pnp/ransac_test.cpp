// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/pnp/ransac.hpp"

#include <limits>

#include "pnp/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(ransac_test)

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

pnp::RansacResult ransac(const Scene& scene, const pnp::RansacOptions& options = {}) {
    return pnp::ransac(scene.X, scene.observations, scene.camera, Loss{}, options);
}

/// 200 of 200 trials succeed in each; four failures are allowed for other compilers' rounding.
struct Setting {
    int landmarks;
    int outliers;
    Vec3 box;
    double range;
};

BOOST_AUTO_TEST_CASE(finds_the_pose_among_outliers) {
    Random random(1);
    for (const Setting& s :
         {Setting{4, 0, Vec3(1, 1, 1), 8.0}, Setting{10, 0, Vec3(1, 1, 1), 8.0}, Setting{10, 3, Vec3(1, 1, 1), 8.0},
          Setting{20, 10, Vec3(1, 1, 1), 8.0}, Setting{40, 24, Vec3(1, 1, 1), 8.0}, Setting{20, 6, Vec3(1, 1, 0), 8.0},
          Setting{20, 6, Vec3(1, 0.1, 0.2), 8.0}, Setting{20, 6, Vec3(1, 1, 1), 100.0}}) {
        int right = 0;
        const int trials = 200;
        for (int i = 0; i < trials; ++i) {
            Scene scene = make_scene(random, s.landmarks, s.box, s.range, s.range < 50.0 ? 0.5 : 0.1);
            spoil(scene, random, s.outliers);
            const pnp::RansacResult result =
                ransac(scene, {.max_iterations = 500, .seed = static_cast<std::uint64_t>(i)});
            BOOST_CHECK(is_finite(result.pose) || !result.ok);
            if (result.ok) BOOST_TEST(result.pose.T_camera_target.t.z() > 0.0);
            right += result.ok && rotation_error(result.pose.T_camera_target, scene.T) < 0.2 ? 1 : 0;
        }
        BOOST_TEST_MESSAGE(s.landmarks << " landmarks, " << s.outliers << " outliers, box " << s.box.transpose()
                                       << ", range " << s.range << ": " << right << " of " << trials);
        BOOST_TEST(right >= trials - 4);
    }
}

BOOST_AUTO_TEST_CASE(the_same_seed_gives_the_same_bits) {
    Random random(2);
    Scene scene = make_scene(random, 20, Vec3(1, 1, 1), 8.0, 1.0);
    spoil(scene, random, 8);
    const pnp::RansacResult a = ransac(scene, {.seed = 7}), b = ransac(scene, {.seed = 7});
    BOOST_CHECK(a.ok && b.ok);
    BOOST_CHECK(a.pose.T_camera_target.R == b.pose.T_camera_target.R &&
                a.pose.T_camera_target.t == b.pose.T_camera_target.t);
    BOOST_TEST(a.iterations == b.iterations);
    BOOST_TEST(a.iterations < 200);
}

BOOST_AUTO_TEST_CASE(stops_early_without_outliers) {
    Random random(3);
    const Scene scene = make_scene(random, 12, Vec3(1, 1, 1), 8.0, 0.0);
    BOOST_TEST(ransac(scene).iterations <= 12);
}

BOOST_AUTO_TEST_CASE(noise_does_not_prolong_the_search) {
    // A pose from three noisy points of a distant target explains only some of the others; refined locally it explains
    // nearly all.
    Random random(7);
    int iterations = 0;
    for (int i = 0; i < 50; ++i) {
        Scene scene = make_scene(random, 20, Vec3(1, 1, 1), 40.0, 1.0);
        spoil(scene, random, 10);
        const pnp::RansacResult result = ransac(scene, {.max_iterations = 1000, .seed = static_cast<std::uint64_t>(i)});
        BOOST_TEST(result.ok);
        iterations += result.iterations;
    }
    // Half of 20: log(1e-4) / log(1 - 0.5^3) = 69. Seen: 70, without local refinement 83.
    BOOST_TEST_MESSAGE("mean iterations " << iterations / 50.0);
    BOOST_TEST(iterations < 50 * 75);
}

BOOST_AUTO_TEST_CASE(least_squares_is_allowed) {
    Random random(4);
    const Scene scene = make_scene(random, 12, Vec3(1, 1, 1), 8.0, 1.0);
    const pnp::RansacResult result = pnp::ransac(scene.X, scene.observations, scene.camera, Loss{kInf});
    BOOST_TEST(result.ok);
    BOOST_TEST(rotation_error(result.pose.T_camera_target, scene.T) < 0.05);
}

BOOST_AUTO_TEST_CASE(degenerate_tasks_are_not_ok) {
    Random random(5);
    const Scene scene = make_scene(random, 10, Vec3(1, 1, 1), 8.0, 0.0);
    const auto with = [&](auto change) {
        Scene changed = scene;
        change(changed);
        return ransac(changed).ok;
    };
    const auto place = [&](auto position) {
        return with([&](Scene& s) {
            for (std::size_t j = 0; j < s.X.size(); ++j) {
                s.X[j] = position(static_cast<double>(j));
                (void)s.camera.project(s.T * s.X[j], s.observations[j].z);
            }
        });
    };
    BOOST_TEST(with([](Scene&) {}));
    BOOST_TEST(!with([](Scene& s) { s.observations.clear(); }));
    BOOST_TEST(!with([](Scene& s) { s.observations.resize(3); }));
    BOOST_TEST(!with([](Scene& s) { s.X.clear(); }));
    BOOST_TEST(!place([](double j) { return Vec3(j, 2.0 * j, -j); }));
    BOOST_TEST(!place([](double) { return Vec3(1, 2, 3); }));
    BOOST_TEST(!place([](double j) { return Vec3(1e200 * j, -1e200, 1e200); }));
    // Three places seen several times leave up to four poses.
    BOOST_TEST(
        !place([](double j) { return Vec3(std::fmod(j, 3.0) == 1.0 ? 1 : 0, std::fmod(j, 3.0) == 2.0 ? 1 : 0, 0); }));
    BOOST_TEST(!with([](Scene& s) {
        for (Observation& o : s.observations) o.landmark = 0;
    }));
    BOOST_TEST(!with([](Scene& s) {
        for (Observation& o : s.observations) o.z.x() = kNaN;
    }));
    BOOST_TEST(!with([](Scene& s) {
        for (Observation& o : s.observations) o.covariance.setConstant(kInf);
    }));
}

BOOST_AUTO_TEST_CASE(rubbish_is_seldom_taken_for_a_pose) {
    // All outliers: 20 random pixels. A pose may by chance agree with a few of them, never with half.
    Random random(6);
    for (int i = 0; i < 100; ++i) {
        Scene scene = make_scene(random, 20, Vec3(1, 1, 1), 8.0, 1.0);
        spoil(scene, random, 20);
        const pnp::RansacResult result = ransac(scene);
        BOOST_CHECK(!result.ok || (result.pose.inliers < 10 && is_finite(result.pose)));
    }
}

BOOST_AUTO_TEST_SUITE_END()
