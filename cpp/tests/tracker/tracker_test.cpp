// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>

#include "fairlead/refine.hpp"
#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

namespace {

constexpr std::int64_t kFrame = 40'000'000;

double nees(const Vec6& error, const Mat66& covariance) { return error.dot(covariance.llt().solve(error)); }

VecX model_error(std::span<const Vec3> X, const Scene& scene) {
    VecX error(3 * static_cast<Eigen::Index>(X.size()));
    for (std::size_t j = 0; j < X.size(); ++j)
        error.segment<3>(3 * static_cast<Eigen::Index>(j)) = X[j] - scene.X_true[j];
    return error;
}

}  // namespace

BOOST_AUTO_TEST_CASE(first_view_already_has_a_pose_and_the_model_improves) {
    const Scene scene = make_scene(20, 40, 1.5, 1.0, 1.0, 21);
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0));
    const double before = model_error(scene.X_told, scene).norm();
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const Estimate e = tracker.update(kFrame * static_cast<std::int64_t>(k), scene.views[k]);
        BOOST_TEST(e.ok());
        BOOST_TEST(e.inliers >= 19);
        BOOST_TEST(nees(difference(e.T_camera_target, scene.T_true[k]), e.covariance) <
                   33.1);  // 99.999 % of chi-square, 6 dof
        BOOST_TEST(e.resets == 0);
    }
    BOOST_TEST(model_error(tracker.landmarks(), scene).norm() < 0.7 * before);
}

BOOST_AUTO_TEST_CASE(window_that_holds_everything_is_the_batch) {
    const Scene scene = make_scene(20, 30, 1.5, 1.0, 0.5, 22);
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 0.5));
    std::vector<BatchView> batch;
    Estimate last;
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const std::int64_t stamp = kFrame * static_cast<std::int64_t>(k);
        last = tracker.update(stamp, scene.views[k]);
        batch.push_back({stamp, scene.views[k]});
    }
    const Refinement all = refine(scene.camera, scene.X_told, independent_prior(scene, 0.5), batch);
    // The factors are measured once a view here and to convergence there: a small part of one standard deviation in 60
    // dimensions.
    const VecX shift = model_error(tracker.landmarks(), scene) - model_error(all.X, scene);
    BOOST_TEST(std::sqrt(shift.dot(all.covariance.llt().solve(shift))) < 0.5);
    BOOST_TEST(nees(difference(last.T_camera_target, all.estimates.back().T_camera_target), last.covariance) < 0.04);
    BOOST_TEST((tracker.landmark_covariance() - all.covariance).norm() < 0.1 * all.covariance.norm());
}

BOOST_AUTO_TEST_CASE(small_window_forgets_nothing) {
    const Scene scene = make_scene(20, 200, 1.5, 1.0, 1.0, 23);
    TrackerOptions narrow;
    narrow.max_views = 8;
    Tracker small(scene.camera, scene.X_told, independent_prior(scene, 1.0), narrow);
    std::vector<BatchView> batch;
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const std::int64_t stamp = kFrame * static_cast<std::int64_t>(k);
        (void)small.update(stamp, scene.views[k]);
        batch.push_back({stamp, scene.views[k]});
    }
    const Refinement all = refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), batch);
    BOOST_TEST(small.views_in_window() == 8);
    // Eight views alone would leave 25 times the covariance of the shape.
    BOOST_TEST(small.landmark_covariance().trace() < 1.05 * all.covariance.trace());
    const VecX error = model_error(small.landmarks(), scene);
    BOOST_TEST(error.dot(small.landmark_covariance().llt().solve(error)) <
               112.0);  // 99.99 % of chi-square, 60 dof, rounded up
}

BOOST_AUTO_TEST_CASE(a_wrong_sigma_is_measured) {
    Scene scene = make_scene(20, 60, 1.5, 2.0, 1.0, 24);
    for (auto& view : scene.views)
        for (Observation& o : view) o.covariance *= 0.25;  // told 1 px where it is 2
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0));
    for (std::size_t k = 0; k < scene.views.size(); ++k)
        (void)tracker.update(kFrame * static_cast<std::int64_t>(k), scene.views[k]);
    BOOST_TEST(tracker.noise_factor() > 3.6);
    BOOST_TEST(tracker.noise_factor() < 4.4);
}

BOOST_AUTO_TEST_CASE(order_of_observations_is_irrelevant_and_runs_repeat_bit_by_bit) {
    Scene scene = make_scene(20, 12, 1.0, 1.0, 1.0, 25);
    Tracker forward(scene.camera, scene.X_told, independent_prior(scene, 1.0));
    Tracker again(scene.camera, scene.X_told, independent_prior(scene, 1.0));
    Tracker reversed(scene.camera, scene.X_told, independent_prior(scene, 1.0));
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const std::int64_t stamp = kFrame * static_cast<std::int64_t>(k);
        const Estimate a = forward.update(stamp, scene.views[k]);
        const Estimate b = again.update(stamp, scene.views[k]);
        std::reverse(scene.views[k].begin(), scene.views[k].end());
        const Estimate c = reversed.update(stamp, scene.views[k]);
        BOOST_TEST((a.T_camera_target.t.array() == b.T_camera_target.t.array()).all());
        BOOST_TEST((a.covariance.array() == b.covariance.array()).all());
        BOOST_TEST(nees(difference(a.T_camera_target, c.T_camera_target), a.covariance) < 0.04);
    }
}

BOOST_AUTO_TEST_CASE(prediction_looks_where_the_target_will_be_and_changes_nothing) {
    const Scene scene = make_scene(20, 60, 1.5, 0.1, 0.1, 26);
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 0.1));
    Tracker undisturbed(scene.camera, scene.X_told, independent_prior(scene, 0.1));
    BOOST_TEST(!tracker.predict(0).ok());  // nothing found yet
    constexpr std::size_t kAhead = 10;
    const auto bow = static_cast<std::size_t>(0);
    double carried = 0.0, left = 0.0;  // [px] error of where a landmark is looked for
    for (std::size_t k = 0; k + kAhead < scene.views.size(); ++k) {
        const std::int64_t stamp = kFrame * static_cast<std::int64_t>(k);
        const Estimate e = tracker.update(stamp, scene.views[k]);
        const Estimate ahead = tracker.predict(stamp + kFrame * static_cast<std::int64_t>(kAhead));
        BOOST_TEST((ahead.status == Status::coasting));
        BOOST_TEST((ahead.covariance - e.covariance).trace() > 0.0);
        BOOST_TEST((undisturbed.update(stamp, scene.views[k]).covariance.array() == e.covariance.array()).all());
        Vec2 truth, there, here;
        const Vec3& X = scene.X_true[bow];
        BOOST_REQUIRE(scene.camera.project(scene.T_true[k + kAhead] * X, truth));
        BOOST_REQUIRE(scene.camera.project(ahead.T_camera_target * X, there));
        BOOST_REQUIRE(scene.camera.project(e.T_camera_target * X, here));
        if (k < 20) continue;  // the rate is taken over half a second
        carried += (there - truth).norm();
        left += (here - truth).norm();
    }
    BOOST_TEST(carried < 0.5 * left);
    const std::int64_t last = kFrame * static_cast<std::int64_t>(scene.views.size() - kAhead - 1);
    BOOST_TEST((tracker.predict(last - 1).reason == Reason::stamp));
    BOOST_TEST(!tracker.predict(last + 510'000'000).ok());
    BOOST_TEST(tracker.predict(last + 510'000'000).covariance.hasNaN());
}
