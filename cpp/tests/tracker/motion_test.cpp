// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>

#include "fairlead/tracker.hpp"
#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

namespace {

constexpr std::int64_t kFrame = 40'000'000;

struct Flown {
    double range_rms = 0.0;  ///< second half [m]
    double nees = 0.0;       ///< of the range, mean
    int believed = 0, refused = 0;
    RangeBias range_bias;
};

/// 10 s along an arc at 1 km with 4 px of noise; `reading(k)` adds what other sensors say at frame k.
template <typename Reading>
Flown fly(const Scene& scene, const TrackerOptions& options, const Reading& reading) {
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0), options);
    Flown flown;
    const std::size_t half = scene.views.size() / 2;
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const std::int64_t stamp = kFrame * static_cast<std::int64_t>(k);
        reading(tracker, stamp, scene.T_true[k]);
        const Estimate e = tracker.update(stamp, scene.views[k]);
        BOOST_TEST_REQUIRE(e.ok());
        BOOST_TEST(e.covariance.llt().info() == Eigen::Success);
        if (k < half) continue;
        const double error = scene.T_true[k].t.norm() - e.T_camera_target.t.norm();
        const Vec3 along = e.T_camera_target.R.transpose() * e.T_camera_target.t.normalized();
        flown.range_rms += error * error / static_cast<double>(half);
        flown.nees += error * error / along.dot(e.covariance.topLeftCorner<3, 3>() * along) / static_cast<double>(half);
    }
    flown.range_rms = std::sqrt(flown.range_rms);
    flown.believed = tracker.ranges_believed();
    flown.refused = tracker.ranges_refused();
    flown.range_bias = tracker.range_bias();
    return flown;
}

Scene flight(std::uint64_t seed) { return make_scene(20, 250, 0.5, 4.0, 1.0, seed); }

/// From 1 km to 300 m, along an arc.
Scene approach(std::uint64_t seed) {
    Scene scene = make_scene(20, 250, 0.5, 0.5, 1.0, seed);
    std::mt19937_64 random(seed + 1000);
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(scene.views.size());
        scene.T_true[k] = look_at(3.3 + 0.5 * share, 0.26, 1000.0 - 700.0 * share, Vec3(70.0, 0.0, 16.0));
        scene.views[k].clear();
        for (int j = 0; j < 20; ++j) {
            Vec2 z;
            if (!scene.camera.project(scene.T_true[k] * scene.X_true[static_cast<std::size_t>(j)], z)) continue;
            scene.views[k].push_back({j, z + gaussian(random, 0.5).head<2>(), 0.25 * Mat22::Identity()});
        }
    }
    return scene;
}
constexpr auto kNothing = [](Tracker&, std::int64_t, const SE3&) {};

TrackerOptions smooth(motion::Kind kind) {
    TrackerOptions options;
    options.motion = kind;
    return options;
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_smooth_path_makes_the_range_more_accurate_than_single_views) {
    double alone = 0.0;
    std::array<double, 3> squares{};
    const std::array<motion::Kind, 3> kinds{motion::Kind::range, motion::Kind::target, motion::Kind::world};
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Scene scene = flight(seed);
        alone += std::pow(fly(scene, {}, kNothing).range_rms, 2);
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            const Flown flown = fly(scene, smooth(kinds[i]), [](Tracker& tracker, std::int64_t stamp, const SE3& T) {
                tracker.add_attitude(stamp, T.R.transpose(), 1e-3);
            });
            squares[i] += std::pow(flown.range_rms, 2);
            BOOST_TEST(flown.nees < 8.0);
        }
    }
    for (const double sum : squares) BOOST_TEST(std::sqrt(sum / alone) < 0.7);
}

BOOST_AUTO_TEST_CASE(ranges_fix_the_range_and_wrong_ones_do_no_harm) {
    for (const bool outliers : {false, true}) {
        const Scene scene = flight(4);
        int reading = 0;
        const Flown flown =
            fly(scene, smooth(motion::Kind::range), [&](Tracker& tracker, std::int64_t stamp, const SE3& T) {
                if (stamp % (12 * kFrame) != 0) return;
                const double wrong = outliers && ++reading % 6 == 3 ? 50.0 : 0.0;
                const Vec3 p = T * scene.X_true[2];
                tracker.add_range(stamp, p.norm() + wrong, 0.5, 2);
            });
        BOOST_TEST(flown.range_rms < 4.0);
        BOOST_TEST(flown.refused == 3 + (outliers ? 4 : 0));
        BOOST_TEST(flown.believed == 18 - (outliers ? 4 : 0));
    }
}

BOOST_AUTO_TEST_CASE(a_range_to_the_origin_is_one_to_a_landmark_that_is_known) {
    const Scene scene = flight(5);
    TrackerOptions options = smooth(motion::Kind::range);
    options.range_to_origin = true;
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0), options);
    BOOST_TEST(tracker.landmarks().size() == scene.X_told.size());
    BOOST_TEST(tracker.landmark_covariance().rows() == 3 * std::ssize(scene.X_told));
    const Flown flown = fly(scene, options, [&](Tracker& t, std::int64_t stamp, const SE3& T) {
        if (stamp % (12 * kFrame) == 0) t.add_range(stamp, T.t.norm(), 0.5, Tracker::kOrigin);
    });
    BOOST_TEST(flown.range_rms < 4.0);
}

BOOST_AUTO_TEST_CASE(what_a_range_finder_always_reads_too_much_is_found_while_the_range_changes) {
    double nees = 0.0, told_nothing = 0.0, estimated = 0.0;
    constexpr int kSeeds = 12;
    for (int seed = 0; seed < kSeeds; ++seed) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed) + 100);
        const double bias = gaussian(random, 3.0).x();
        const Scene scene = approach(static_cast<std::uint64_t>(seed));
        TrackerOptions options = smooth(seed % 2 == 0 ? motion::Kind::none : motion::Kind::range);
        const auto reading = [&](Tracker& tracker, std::int64_t stamp, const SE3& T) {
            if (stamp % (5 * kFrame) != 0) return;
            tracker.add_range(stamp, (T * scene.X_true[2]).norm() + bias + gaussian(random, 0.1).x(), 0.1, 2);
        };
        told_nothing += std::pow(fly(scene, options, reading).range_rms, 2) / kSeeds;
        options.range_bias_sigma_m = 3.0;
        const Flown flown = fly(scene, options, reading);
        estimated += std::pow(flown.range_rms, 2) / kSeeds;
        BOOST_TEST(flown.range_bias.sigma_m < 1.5);
        nees += std::pow((flown.range_bias.bias_m - bias) / flown.range_bias.sigma_m, 2) / kSeeds;
    }
    BOOST_TEST(nees > 0.3);  // 99 % bands of chi-square with 12 degrees of freedom
    BOOST_TEST(nees < 2.2);
    BOOST_TEST(estimated < 0.5 * told_nothing);
}

BOOST_AUTO_TEST_CASE(a_known_length_fixes_the_scale) {
    const Scene scene = make_scene(20, 30, 1.5, 0.5, 1.0, 6);
    const auto scale_error = [&](bool told) {
        Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0));
        if (told)
            for (int j = 1; j < 20; ++j)
                tracker.add_length(0, j, (scene.X_true[0] - scene.X_true[static_cast<std::size_t>(j)]).norm(), 0.01);
        for (std::size_t k = 0; k < scene.views.size(); ++k)
            static_cast<void>(tracker.update(kFrame * static_cast<std::int64_t>(k), scene.views[k]));
        double estimated = 0.0, real = 0.0;
        for (std::size_t j = 1; j < 20; ++j) {
            estimated += (tracker.landmarks()[0] - tracker.landmarks()[j]).norm();
            real += (scene.X_true[0] - scene.X_true[j]).norm();
        }
        return std::abs(estimated / real - 1.0);
    };
    BOOST_TEST(scale_error(true) < 2e-4);
    BOOST_TEST(scale_error(true) < 0.5 * scale_error(false));
}

BOOST_AUTO_TEST_CASE(a_pose_that_is_told_starts_the_search) {
    const Scene scene = make_scene(20, 1, 0.0, 1.0, 1.0, 9);
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0));
    const std::vector<Observation> three(scene.views[0].begin(), scene.views[0].begin() + 3);
    BOOST_TEST(!tracker.update(0, three).ok());
    tracker.add_pose(kFrame, scene.T_true[0], Mat66::Identity() * 1e-2);
    const Estimate e = tracker.update(2 * kFrame, three);
    BOOST_TEST(e.ok());
    BOOST_TEST((e.status == Status::coasting));
}

BOOST_AUTO_TEST_CASE(readings_that_mean_nothing_are_refused_with_one_line) {
    const Scene scene = make_scene(6, 1, 0.0, 1.0, 1.0, 9);
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0));
    BOOST_CHECK_THROW(tracker.add_range(0, -1.0, 0.5, 0), std::invalid_argument);
    BOOST_CHECK_THROW(tracker.add_range(0, 100.0, 0.0, 0), std::invalid_argument);
    BOOST_CHECK_THROW(tracker.add_range(0, 100.0, 0.5, 6), std::invalid_argument);
    BOOST_CHECK_THROW(tracker.add_range(0, 100.0, 0.5, Tracker::kOrigin), std::invalid_argument);
    BOOST_CHECK_THROW(tracker.add_length(0, 0, 1.0, 0.1), std::invalid_argument);
    BOOST_CHECK_THROW(tracker.add_length(0, 1, std::nan(""), 0.1), std::invalid_argument);
    BOOST_CHECK_THROW(tracker.add_attitude(0, 2.0 * Mat33::Identity(), 0.1), std::invalid_argument);
    BOOST_CHECK_THROW(tracker.add_pose(0, SE3{}, -Mat66::Identity()), std::invalid_argument);
}
