// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <limits>

#include "fairlead/refine.hpp"
#include "fairlead/tracker.hpp"
#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

namespace {

constexpr std::int64_t kFrame = 40'000'000;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Whatever came in: a finite pose with a positive definite covariance, or NaN and a reason.
void check_honest(const Estimate& e) {
    if (e.ok()) {
        BOOST_TEST(e.T_camera_target.t.allFinite());
        BOOST_TEST(e.T_camera_target.R.isUnitary(1e-9));
        BOOST_TEST(e.covariance.allFinite());
        BOOST_TEST((e.covariance.llt().info() == Eigen::Success));
    } else {
        BOOST_TEST(e.T_camera_target.t.array().isNaN().all());
        BOOST_TEST(e.covariance.array().isNaN().all());
        BOOST_TEST((e.reason != Reason::none));
    }
}

struct Flight {
    explicit Flight(std::uint64_t seed, int views = 60)
        : scene(make_scene(20, views, 0.5, 1.0, 1.0, seed)),
          tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0)) {}

    Estimate fly(std::size_t k) { return update(k, scene.views[k]); }
    Estimate update(std::size_t k, const std::vector<Observation>& view) {
        const Estimate e = tracker.update(kFrame * static_cast<std::int64_t>(k + 1), view);
        check_honest(e);
        return e;
    }
    double error(std::size_t k, const Estimate& e) const {
        const Vec6 d = difference(e.T_camera_target, scene.T_true[k]);
        return d.dot(e.covariance.llt().solve(d));
    }

    Scene scene;
    Tracker tracker;
};

constexpr double kSix = 33.1;  // 99.999 % of chi-square with 6 degrees of freedom

}  // namespace

BOOST_AUTO_TEST_CASE(not_a_number_is_dropped_and_counted) {
    Flight flight(31);
    for (std::size_t k = 0; k < 10; ++k) {
        auto view = flight.scene.views[k];
        view[0].z.x() = kNaN;
        view[1].z.y() = std::numeric_limits<double>::infinity();
        view[2].covariance(0, 0) = kNaN;
        view[3].covariance.setZero();
        view[4].landmark = 99;
        view[5].landmark = -1;
        view[7] = view[6];
        const Estimate e = flight.update(k, view);
        BOOST_TEST(e.ok());
        BOOST_TEST(e.dropped == 7);
        BOOST_TEST(flight.error(k, e) < kSix);
    }
}

BOOST_AUTO_TEST_CASE(too_few_landmarks_coast_then_are_lost_then_come_back) {
    Flight flight(32);
    std::size_t k = 0;
    for (; k < 15; ++k) BOOST_TEST(flight.fly(k).ok());
    double before = 0.0;
    for (; k < 27; ++k) {  // 12 views: 0.48 s
        const Estimate e =
            flight.update(k, {flight.scene.views[k][2], flight.scene.views[k][11], flight.scene.views[k][5]});
        BOOST_TEST((e.status == Status::coasting));
        BOOST_TEST((e.reason == Reason::too_few));
        BOOST_TEST(flight.error(k, e) < kSix);
        before = e.covariance.topLeftCorner<3, 3>().trace();
    }
    BOOST_TEST(before > 0.0);
    for (; k < 30; ++k) {
        const Estimate e = flight.update(k, {});
        BOOST_TEST((e.status == Status::lost));
    }
    const auto model = std::vector<Vec3>(flight.tracker.landmarks().begin(), flight.tracker.landmarks().end());
    const Estimate back = flight.fly(k);
    BOOST_TEST(back.ok());
    BOOST_TEST(flight.error(k, back) < kSix);
    BOOST_TEST(back.resets == 1);
    BOOST_TEST((model[0] - flight.tracker.landmarks()[0]).norm() < 0.2);
}

BOOST_AUTO_TEST_CASE(covariance_grows_while_nothing_is_seen) {
    Flight flight(33);
    for (std::size_t k = 0; k < 15; ++k) (void)flight.fly(k);
    double last = 0.0;
    for (std::size_t k = 15; k < 27; ++k) {
        const Estimate e = flight.update(k, {});
        BOOST_TEST((e.status == Status::coasting));
        BOOST_TEST(e.covariance.trace() > last);
        last = e.covariance.trace();
    }
}

BOOST_AUTO_TEST_CASE(identical_and_collinear_points_are_degenerate) {
    Flight flight(34);
    auto same = flight.scene.views[0];
    for (Observation& o : same) o.z = same[0].z;
    BOOST_TEST(!flight.update(0, same).ok());

    std::vector<Vec3> line;
    for (int j = 0; j < 8; ++j) line.emplace_back(10.0 * j, 1.0, 2.0);
    Tracker tracker(flight.scene.camera, line, MatX::Identity(24, 24) * 1e-6);
    const SE3 T = look_at(3.3, 0.26, 1000.0, Vec3(35, 1, 2));
    std::vector<Observation> view;
    for (int j = 0; j < 8; ++j) {
        Vec2 z;
        BOOST_TEST_REQUIRE(flight.scene.camera.project(T * line[static_cast<std::size_t>(j)], z));
        view.push_back({j, z, Mat22::Identity()});
    }
    const Estimate e = tracker.update(1, view);
    check_honest(e);
    BOOST_TEST(!e.ok());
    BOOST_TEST((e.reason == Reason::degenerate));
}

BOOST_AUTO_TEST_CASE(wrong_matches_are_gated_or_nothing_is_claimed) {
    for (const double share : {0.3, 0.5, 1.0}) {
        Flight flight(35);
        std::mt19937_64 random(36);
        std::uniform_real_distribution<double> pixel(0.0, 1023.0);
        int wrong = 0;
        int confident = 0;
        for (std::size_t k = 0; k < 40; ++k) {
            auto view = flight.scene.views[k];
            for (std::size_t i = 0; i < static_cast<std::size_t>(share * 20.0); ++i)
                view[(i * 7 + k) % 20].z = {pixel(random), pixel(random)};
            const Estimate e = flight.update(k, view);
            confident += e.ok();
            wrong += e.ok() && flight.error(k, e) > 2.0 * kSix;
        }
        BOOST_TEST_CONTEXT("share " << share) {
            BOOST_TEST(wrong == 0);
            if (share == 0.3) BOOST_TEST(confident == 40);
        }
    }
}

BOOST_AUTO_TEST_CASE(stamps_that_do_not_advance_are_dropped_until_the_clock_is_new) {
    Flight flight(37);
    for (std::size_t k = 0; k < 10; ++k) (void)flight.fly(k);
    for (const std::int64_t stamp : {10 * kFrame, 5 * kFrame, std::int64_t{0}}) {
        const Estimate e = flight.tracker.update(stamp, flight.scene.views[10]);
        check_honest(e);
        BOOST_TEST((e.reason == Reason::stamp));
    }
    BOOST_TEST(flight.fly(10).ok());
    // A camera that restarts its clock at zero is believed after ten views in order.
    int ok = 0;
    for (std::size_t k = 0; k < 30; ++k) {
        const Estimate e = flight.tracker.update(static_cast<std::int64_t>(k), flight.scene.views[k]);
        check_honest(e);
        ok += e.ok();
    }
    BOOST_TEST(ok == 21);
}

BOOST_AUTO_TEST_CASE(long_gap_and_far_future_go_on) {
    Flight flight(38);
    for (std::size_t k = 0; k < 10; ++k) (void)flight.fly(k);
    const Estimate e = flight.tracker.update(std::int64_t{3600} * 1'000'000'000, flight.scene.views[30]);
    check_honest(e);
    BOOST_TEST(e.ok());
    BOOST_TEST(flight.error(30, e) < kSix);
}

BOOST_AUTO_TEST_CASE(a_flip_is_not_believed_at_once) {
    Flight flight(39);
    for (std::size_t k = 0; k < 15; ++k) (void)flight.fly(k);
    const SE3 flipped = look_at(3.3 + 3.14159, 0.26, 1000.0, Vec3(70.0, 0.0, 16.0));
    int believed = 0;
    for (std::size_t k = 15; k < 25; ++k) {
        std::vector<Observation> view;  // seen from the other side: a real jump, with evidence
        for (int j = 0; j < 20; ++j) {
            Vec2 z;
            BOOST_TEST_REQUIRE(
                flight.scene.camera.project(flipped * flight.scene.X_true[static_cast<std::size_t>(j)], z));
            view.push_back({j, z, Mat22::Identity()});
        }
        const Estimate e = flight.update(k, view);
        if (e.status == Status::tracking) {
            ++believed;
            BOOST_TEST(e.resets == 1);
        }
    }
    BOOST_TEST(believed >= 7);
}

BOOST_AUTO_TEST_CASE(wrong_intrinsics_raise_the_alarm) {
    // Seen from afar a wrong focal length is a wrong range; an accurate model at 0.25 px shows it by its perspective.
    Scene scene = make_scene(20, 60, 1.5, 0.25, 0.01, 40);
    scene.camera.fx *= 1.3;
    scene.camera.fy *= 1.3;
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 0.01));
    int alarms = 0;
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const Estimate e = tracker.update(kFrame * static_cast<std::int64_t>(k + 1), scene.views[k]);
        check_honest(e);
        alarms += !e.ok() || e.reason == Reason::alarm;
    }
    BOOST_TEST(alarms > 40);
}

BOOST_AUTO_TEST_CASE(errors_that_stay_contradict_what_was_told_and_honest_ones_do_not) {
    for (const double stays_px : {0.0, 5.0}) {
        Flight flight(44);
        std::mt19937_64 random(45);
        std::vector<Vec3> bias;
        for (std::size_t j = 0; j < flight.scene.X_told.size(); ++j) bias.push_back(gaussian(random, stays_px));
        std::vector<BatchView> batch;
        for (std::size_t k = 0; k < flight.scene.views.size(); ++k) {
            for (Observation& o : flight.scene.views[k]) o.z += bias[static_cast<std::size_t>(o.landmark)].head<2>();
            batch.push_back({static_cast<std::int64_t>(k), flight.scene.views[k]});
            const Estimate e = flight.fly(k);
            BOOST_TEST(e.ok());
            if (k > 5) BOOST_TEST((e.reason == Reason::contradiction) == (stays_px > 0.0));
        }
        const Scene& scene = flight.scene;
        for (const Estimate& e : refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), batch).estimates)
            BOOST_TEST((e.reason == Reason::contradiction) == (stays_px > 0.0));
    }
}

BOOST_AUTO_TEST_CASE(caller_errors_are_named_at_construction) {
    const Scene scene = make_scene(20, 1, 0.0, 1.0, 1.0, 41);
    const auto make = [&](const MatX& P0, const TrackerOptions& options) {
        return Tracker(scene.camera, scene.X_told, P0, options);
    };
    TrackerOptions none;
    none.max_views = 0;
    BOOST_CHECK_THROW(make(independent_prior(scene, 1.0), none), std::invalid_argument);
    BOOST_CHECK_THROW(make(MatX::Identity(59, 59), {}), std::invalid_argument);
    BOOST_CHECK_THROW(make(-MatX::Identity(60, 60), {}), std::invalid_argument);
    BOOST_CHECK_THROW(make(MatX::Constant(60, 60, kNaN), {}), std::invalid_argument);
    BOOST_CHECK_THROW(Tracker(scene.camera, std::span(scene.X_told).first(3), MatX::Identity(9, 9)),
                      std::invalid_argument);
    BOOST_CHECK_THROW(Tracker(Camera{}, scene.X_told, independent_prior(scene, 1.0)), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(a_batch_names_the_inliers_of_each_view) {
    Scene scene = make_scene(20, 12, 1.0, 1.0, 1.0, 43);
    std::vector<BatchView> batch;
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        scene.views[k][k].z += Vec2(60.0, -60.0);
        if (k == 5) scene.views[k].resize(3);  // no pose
        batch.push_back({static_cast<std::int64_t>(k), scene.views[k]});
    }
    Refinement found = refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), batch);
    const Refinement all = std::move(found);  // the lists move along
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        std::vector<int> expected;
        for (const Observation& o : scene.views[k])
            if (k != 5 && o.landmark != static_cast<int>(k)) expected.push_back(o.landmark);
        const Estimate& e = all.estimates[k];
        BOOST_TEST(all.inliers[k] == expected, boost::test_tools::per_element());
        BOOST_TEST(e.inliers == static_cast<int>(expected.size()));
        BOOST_TEST(e.inlier_landmarks.data() == all.inliers[k].data());
        BOOST_TEST(e.inlier_landmarks.size() == expected.size());
    }
}

BOOST_AUTO_TEST_CASE(batch_of_bad_views_keeps_the_good_ones) {
    Scene scene = make_scene(20, 12, 1.0, 1.0, 1.0, 42);
    scene.views[3].clear();
    scene.views[5].resize(3);
    for (Observation& o : scene.views[7]) o.z.setConstant(kNaN);
    std::vector<BatchView> batch;
    for (std::size_t k = 0; k < scene.views.size(); ++k)
        batch.push_back({static_cast<std::int64_t>(k), scene.views[k]});
    const Refinement all = refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), batch);
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        check_honest(all.estimates[k]);
        BOOST_TEST(all.estimates[k].ok() == (k != 3 && k != 5 && k != 7));
    }
    const Refinement nothing = refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), {});
    BOOST_TEST(nothing.estimates.empty());
    BOOST_TEST((nothing.covariance - independent_prior(scene, 1.0)).norm() < 1e-9);
}
