// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <numbers>

#include "fairlead/refine.hpp"
#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

namespace {

constexpr std::int64_t kFrame = 100'000'000;

std::vector<BatchView> stamped(const Scene& scene) {
    std::vector<BatchView> views;
    for (std::size_t k = 0; k < scene.views.size(); ++k)
        views.push_back({kFrame * static_cast<std::int64_t>(k), scene.views[k]});
    return views;
}

struct Score {
    double range_squares = 0.0;  ///< mean [m^2]
    double nees = 0.0;           ///< of the range, mean
};

Score score(const Refinement& found, const Scene& scene) {
    Score score;
    const auto n = static_cast<double>(scene.views.size());
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const Estimate& e = found.estimates[k];
        BOOST_TEST_REQUIRE(e.ok());
        BOOST_TEST(e.covariance.llt().info() == Eigen::Success);
        const double error = scene.T_true[k].t.norm() - e.T_camera_target.t.norm();
        const Vec3 along = e.T_camera_target.R.transpose() * e.T_camera_target.t.normalized();
        score.range_squares += error * error / n;
        score.nees += error * error / along.dot(e.covariance.topLeftCorner<3, 3>() * along) / n;
    }
    return score;
}

/// A straight approach from 1000 m to 300 m.
Scene approach(std::uint64_t seed) {
    Scene scene = make_scene(20, 40, 0.6, 1.0, 1.0, seed);
    std::mt19937_64 random(seed + 100);
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const double part = static_cast<double>(k) / 39.0;
        scene.T_true[k] = look_at(3.3 + 0.3 * part, 0.26, 1000.0 - 700.0 * part, Vec3(70.0, 0.0, 16.0));
        for (Observation& o : scene.views[k]) {
            BOOST_REQUIRE(
                scene.camera.project(scene.T_true[k] * scene.X_true[static_cast<std::size_t>(o.landmark)], o.z));
            o.z += gaussian(random, 1.0).head<2>();
        }
    }
    return scene;
}

BatchReadings readings_of(const Scene& scene, double bias_m, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    BatchReadings readings;
    for (std::size_t k = 0; k < scene.views.size(); ++k)
        readings.ranges.push_back(
            {kFrame * static_cast<std::int64_t>(k) + 1'000'000,
             {3, (scene.T_true[k] * scene.X_true[3]).norm() + bias_m + 0.3 * gaussian(random, 1.0).x(), 0.3}});
    return readings;
}

}  // namespace

BOOST_AUTO_TEST_CASE(outliers_of_a_few_sigma_do_not_widen_the_noise) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
        Scene scene = make_scene(20, 10, 1.5, 4.0, 1.0, seed);
        std::mt19937_64 random(seed + 50);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        for (std::vector<Observation>& view : scene.views)
            for (Observation& o : view) {
                if (unit(random) > 0.3) continue;
                const double direction = 2.0 * std::numbers::pi * unit(random);
                o.z += 30.0 * Vec2(std::cos(direction), std::sin(direction));
            }
        const Refinement found = refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), stamped(scene));
        BOOST_TEST(found.noise_factor > 0.7);
        BOOST_TEST(found.noise_factor < 3.0);  // 9 with all of them
    }
}

BOOST_AUTO_TEST_CASE(noise_that_was_told_wrong_is_found) {
    for (const double told : {0.1, 0.5, 2.0}) {
        Scene scene = make_scene(20, 20, 1.5, 2.0, 1.0, 7);
        for (std::vector<Observation>& view : scene.views)
            for (Observation& o : view) o.covariance *= told * told;
        const Refinement found = refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), stamped(scene));
        BOOST_TEST(std::abs(found.noise_factor * told * told - 1.0) < 0.2);  // 3 sigma of 580 degrees of freedom
    }
}

BOOST_AUTO_TEST_CASE(a_path_as_a_whole_makes_every_range_more_accurate_and_says_how_much) {
    double alone = 0.0;
    std::array<Score, 3> sums{};
    const std::array<motion::Kind, 3> kinds{motion::Kind::range, motion::Kind::target, motion::Kind::world};
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        const Scene scene = make_scene(20, 80, 0.4, 4.0, 1.0, seed);
        BatchReadings readings;
        for (std::size_t k = 0; k < scene.views.size(); ++k)
            readings.attitudes.push_back(
                {kFrame * static_cast<std::int64_t>(k), {scene.T_true[k].R.transpose(), 1e-3}});
        const std::vector<BatchView> views = stamped(scene);
        alone += score(refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), views), scene).range_squares;
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            TrackerOptions options;
            options.motion = kinds[i];
            const Refinement found =
                refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), views, options, readings);
            BOOST_TEST(found.converged);
            const Score one = score(found, scene);
            sums[i].range_squares += one.range_squares;
            sums[i].nees += one.nees / 4.0;
        }
    }
    for (const Score& sum : sums) {
        BOOST_TEST(std::sqrt(sum.range_squares / alone) < 0.5);
        BOOST_TEST(sum.nees < 4.0);  // one common error of scale a flight: four degrees of freedom in all, 99.7 %
    }
}

BOOST_AUTO_TEST_CASE(ranges_fix_the_scale_and_wrong_ones_do_no_harm) {
    const Scene scene = make_scene(20, 40, 0.6, 1.0, 1.0, 5);
    BatchReadings readings = readings_of(scene, 0.0, 6);
    readings.ranges[7].range.range_m += 50.0;
    readings.ranges[20].range.range_m -= 50.0;
    std::swap(readings.ranges[2], readings.ranges[30]);  // in any order
    const Refinement found =
        refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), stamped(scene), {}, readings);
    BOOST_TEST(found.ranges_refused == 2);
    BOOST_TEST(found.ranges_believed == 38);
    double squares = 0.0;
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        if (k == 7 || k == 20) continue;  // left with what the image says
        const double distance = (found.estimates[k].T_camera_target * found.X[3]).norm();
        squares += std::pow(distance - (scene.T_true[k] * scene.X_true[3]).norm(), 2);
    }
    BOOST_TEST(std::sqrt(squares / 38.0) < 0.4);  // no worse than a reading
}

BOOST_AUTO_TEST_CASE(a_constant_error_of_the_range_finder_is_found_where_the_range_changes) {
    double nees = 0.0;
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
        const double bias = seed % 2 == 0 ? 2.5 : -2.5;
        const Scene scene = approach(seed);
        const BatchReadings readings = readings_of(scene, bias, seed);
        TrackerOptions options;
        options.range_bias_sigma_m = 3.0;
        if (seed > 3) options.motion = motion::Kind::range;
        const Refinement found =
            refine(scene.camera, scene.X_told, independent_prior(scene, 1.0), stamped(scene), options, readings);
        BOOST_TEST(found.range_bias.sigma_m < 2.0);
        nees += std::pow((found.range_bias.bias_m - bias) / found.range_bias.sigma_m, 2);
        BOOST_TEST(score(found, scene).nees < 10.0);
    }
    BOOST_TEST(nees < 22.5);  // chi-square, 6 dof, 99.9 %
}

BOOST_AUTO_TEST_CASE(readings_of_a_batch_that_mean_nothing_are_refused) {
    const Scene scene = make_scene(6, 2, 0.1, 1.0, 1.0, 9);
    const auto refused = [&](const auto& change) {
        BatchReadings readings;
        change(readings);
        BOOST_CHECK_THROW(static_cast<void>(refine(scene.camera, scene.X_told, independent_prior(scene, 1.0),
                                                   stamped(scene), {}, readings)),
                          std::invalid_argument);
    };
    refused([](BatchReadings& r) { r.ranges.push_back({0, {0, -1.0, 0.5}}); });
    refused([](BatchReadings& r) { r.ranges.push_back({0, {6, 100.0, 0.5}}); });
    refused([](BatchReadings& r) { r.ranges.push_back({0, {kOrigin, 100.0, 0.5}}); });
    refused([](BatchReadings& r) { r.lengths.push_back({0, 0, 1.0, 0.1}); });
    BOOST_CHECK_THROW(validate(TrackerOptions{.range_bias_sigma_m = -1.0}), std::invalid_argument);
    refused([](BatchReadings& r) { r.attitudes.push_back({0, {2.0 * Mat33::Identity(), 0.1}}); });
}
