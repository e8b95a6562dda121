// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/pnp/planar.hpp"

#include <limits>

#include "pnp/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(planar_test)

/// A square of half side 1 in the plane z = 0.
Scene square(const SE3& T, double sigma_px, Random& random) {
    Scene scene{.camera = pinhole(),
                .X = {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0)},
                .observations = {},
                .T = T};
    for (int j = 0; j < 6; ++j) {
        Observation o{.landmark = j};
        BOOST_TEST_REQUIRE(scene.camera.project(T * scene.X[static_cast<std::size_t>(j)], o.z));
        o.covariance *= std::max(sigma_px * sigma_px, 1e-4);
        o.z += random.vector<2>(sigma_px);
        scene.observations.push_back(o);
    }
    return scene;
}

BOOST_AUTO_TEST_CASE(mirror_of_a_tilted_square_by_hand) {
    Random random(1);
    const Scene scene = square({so3::exp(Vec3(0.4, 0, 0)), Vec3(0, 0, 10)}, 0.0, random);
    Scene centred = scene;
    centred.observations.resize(4);
    const SE3 T = pnp::mirrored(centred.T, centred.X, centred.observations);
    CHECK_NEAR(T.R, so3::exp(Vec3(-0.4, 0, 0)), 1e-14);
    CHECK_NEAR(T.t, Vec3(0, 0, 10), 1e-14);
}

BOOST_AUTO_TEST_CASE(mirroring_twice_is_nothing) {
    Random random(2);
    for (int i = 0; i < 100; ++i) {
        const Scene scene = make_scene(random, 7, Vec3(1, 0.8, 0.3), 9.0, 0.0);
        const SE3 T = pnp::mirrored(scene.T, scene.X, scene.observations);
        CHECK_NEAR(T.R.transpose() * T.R, Mat33::Identity(), 1e-13);
        BOOST_TEST(T.R.col(0).cross(T.R.col(1)).dot(T.R.col(2)) > 0.0);
        const SE3 back = pnp::mirrored(T, scene.X, scene.observations);
        CHECK_NEAR(back.R, scene.T.R, 1e-12);
        CHECK_NEAR(back.t, scene.T.t, 1e-11);
    }
}

BOOST_AUTO_TEST_CASE(mirror_image_of_a_distant_plane_looks_the_same) {
    // The two images differ by perspective alone: pixels of order f (size / range)^2.
    Random random(3);
    for (const double range : {20.0, 200.0}) {
        const Scene scene = make_scene(random, 12, Vec3(1, 1, 0), range, 0.0);
        const SE3 T = pnp::mirrored(scene.T, scene.X, scene.observations);
        double worst = 0.0;
        for (const Observation& o : scene.observations) {
            Vec2 z;
            BOOST_TEST_REQUIRE(scene.camera.project(T * scene.X[static_cast<std::size_t>(o.landmark)], z));
            worst = std::max(worst, (z - o.z).norm());
        }
        BOOST_TEST(worst < 2.0 * 2.0 * 1910.0 * 2.0 / (range * range));
    }
}

BOOST_AUTO_TEST_CASE(both_minima_of_a_plane_are_found_from_either) {
    Random random(4);
    int both = 0, right = 0;
    for (int i = 0; i < 100; ++i) {
        const SE3 truth{so3::exp(Vec3(0.5, 0.3, 0.2) + random.vector<3>(0.1)), Vec3(0.5, -0.3, 25)};
        const Scene scene = square(truth, 0.2, random);
        const SE3 wrong = pnp::mirrored(truth, scene.X, scene.observations);
        const pnp::PosePair a = pnp::pose_pair(truth, scene.X, scene.observations, scene.camera, Loss{});
        const pnp::PosePair b = pnp::pose_pair(wrong, scene.X, scene.observations, scene.camera, Loss{});
        BOOST_TEST_REQUIRE(a.best.ok);
        BOOST_TEST_REQUIRE(b.best.ok);
        BOOST_TEST(a.best.cost <= a.other.cost);
        both += a.distinct && b.distinct ? 1 : 0;
        CHECK_NEAR(a.best.T_camera_target.R, b.best.T_camera_target.R, 1e-3);
        right += rotation_error(a.best.T_camera_target, truth) < rotation_error(a.other.T_camera_target, truth) ? 1 : 0;
    }
    BOOST_TEST_MESSAGE("distinct in " << both << ", best is the true one in " << right << " of 100");
    BOOST_TEST(both >= 95);
    BOOST_TEST(right >= 80);
}

BOOST_AUTO_TEST_CASE(a_plane_seen_squarely_has_one_minimum) {
    Random random(5);
    const Scene scene = square({Mat33::Identity(), Vec3(0, 0, 10)}, 0.0, random);
    const pnp::PosePair pair = pnp::pose_pair(scene.T, scene.X, scene.observations, scene.camera, Loss{});
    BOOST_TEST(pair.best.ok);
    BOOST_TEST(!pair.distinct);
}

BOOST_AUTO_TEST_CASE(the_pair_is_never_worse_than_the_start) {
    Random random(6);
    for (int i = 0; i < 50; ++i) {
        const Scene scene = make_scene(random, 10, Vec3(1, 1, 1), 8.0, 0.5);
        const pnp::PosePair pair = pnp::pose_pair(scene.T, scene.X, scene.observations, scene.camera, Loss{});
        const pnp::RefineResult alone = pnp::refine(scene.T, scene.X, scene.observations, scene.camera, Loss{}, 50);
        BOOST_TEST(pair.best.ok);
        BOOST_TEST(pair.best.cost <= alone.cost);
    }
}

BOOST_AUTO_TEST_CASE(degenerate_pairs_are_not_ok) {
    Random random(7);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Scene scene = square({Mat33::Identity(), Vec3(0, 0, 10)}, 0.0, random);
    const auto pair = [&] { return pnp::pose_pair(scene.T, scene.X, scene.observations, scene.camera, Loss{}); };
    scene.T.t.z() = nan;
    BOOST_CHECK(!pair().best.ok && !pair().other.ok && !pair().distinct);
    scene.T.t.z() = 10.0;
    for (Vec3& X : scene.X) X = Vec3(1, 2, 3);
    BOOST_CHECK(!pair().best.ok && !pair().distinct);
    scene.observations.clear();
    BOOST_CHECK(!pair().best.ok && !pair().distinct);
}

BOOST_AUTO_TEST_CASE(spread_by_hand) {
    const auto of = [](std::vector<Vec3> X) {
        std::vector<Observation> observations;
        for (int j = 0; j < static_cast<int>(X.size()); ++j) observations.push_back({.landmark = j});
        return pnp::spread(X, observations);
    };
    // Six points on the axes at 3, 2, 1: root mean squares are in that ratio.
    const pnp::Spread box =
        of({Vec3(3, 0, 0), Vec3(-3, 0, 0), Vec3(0, 2, 0), Vec3(0, -2, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)});
    CHECK_NEAR(box.flatness, 0.5, 1e-14);
    CHECK_NEAR(box.straightness, 2.0 / 3.0, 1e-14);
    const pnp::Spread plane = of({Vec3(0, 0, 5), Vec3(1, 0, 5), Vec3(0, 1, 5), Vec3(1, 1, 5)});
    CHECK_NEAR(plane.flatness, 0.0, 1e-7);
    CHECK_NEAR(plane.straightness, 1.0, 1e-7);
    CHECK_NEAR(of({Vec3(0, 0, 1), Vec3(1, 2, 1), Vec3(3, 6, 1)}).straightness, 0.0, 1e-7);
    for (const pnp::Spread& nothing : {of({}), of({Vec3(1, 2, 3)}), of({Vec3(1, 2, 3), Vec3(1, 2, 3)})}) {
        CHECK_NEAR(nothing.flatness, 0.0, 0.0);
        CHECK_NEAR(nothing.straightness, 0.0, 0.0);
    }
}

BOOST_AUTO_TEST_SUITE_END()
