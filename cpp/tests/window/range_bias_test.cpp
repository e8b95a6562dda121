// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// A range finder that always reads too much: one more unknown of the window, and of what left it.
#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>

#include "fairlead/window/levenberg_marquardt.hpp"
#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

namespace {

constexpr int kLandmarks = 12;
constexpr double kBias = 3.0;
constexpr double kBiasSigma = 2.0;

/// Every view carries a range to landmark 4 that is kBias too long; X ends with the bias.
window::Problem ranged(const Scene& scene) {
    window::Problem problem = make_problem(scene, 0.5);
    std::vector<Vec3> X0 = scene.X_told;
    X0.emplace_back(Vec3::Zero());
    MatX P0 = MatX::Zero(3 * kLandmarks + 3, 3 * kLandmarks + 3);
    P0.diagonal().setConstant(0.25);
    P0.diagonal().tail<3>().setConstant(kBiasSigma * kBiasSigma);
    problem.prior = window::make_prior(X0, P0, 1);
    problem.X = X0;
    for (std::size_t k = 0; k < problem.views.size(); ++k) {
        const double range = (scene.T_true[k] * scene.X_true[4]).norm();
        problem.views[k].ranges.push_back({4, range + kBias, 0.3, kLandmarks});
    }
    return problem;
}

double cost(window::Problem problem) {
    BOOST_TEST_REQUIRE(window::linearise(problem));
    return window::posterior_cost(problem);
}

MatX information(window::Problem& problem, window::Workspace& workspace) {
    BOOST_TEST_REQUIRE(window::linearise(problem));
    BOOST_TEST_REQUIRE(window::assemble_data(problem, 0.0, workspace));
    window::scale_and_add_prior(problem, problem.X, workspace);
    return workspace.S.selfadjointView<Eigen::Lower>();
}

}  // namespace

BOOST_AUTO_TEST_CASE(the_solution_is_a_minimum_in_the_bias_too) {
    const Scene scene = make_scene(kLandmarks, 6, 0.8, 0.5, 0.5, 21);
    window::Problem problem = ranged(scene);
    window::Workspace workspace(problem.landmarks());
    BOOST_TEST_REQUIRE(window::levenberg_marquardt(problem, {.tolerance = 1e-16}, workspace).ok);
    BOOST_TEST(std::abs(problem.X.back().x()) > 1e-3);
    BOOST_TEST(problem.X.back().tail<2>().norm() < 1e-12);
    for (const double step : {1e-3, -1e-3}) {
        window::Problem moved = problem;
        moved.X.back().x() += step;
        BOOST_TEST(cost(moved) > cost(problem));
    }
}

BOOST_AUTO_TEST_CASE(the_information_about_the_bias_is_the_curvature_with_all_else_solved_for) {
    const Scene scene = make_scene(kLandmarks, 6, 0.8, 0.5, 0.5, 22);
    window::Problem problem = ranged(scene);
    window::Workspace workspace(problem.landmarks());
    BOOST_TEST_REQUIRE(window::levenberg_marquardt(problem, {.tolerance = 1e-16}, workspace).ok);
    const double best = cost(problem);
    const double sigma = std::sqrt(information(problem, workspace).inverse()(3 * kLandmarks, 3 * kLandmarks));
    BOOST_TEST(sigma < kBiasSigma);
    const double bias = problem.X.back().x() + 0.2 * sigma;  // held there: the readings are that much shorter
    window::Problem held = problem;
    for (window::ViewBlock& view : held.views) view.ranges[0].range_m -= bias;
    held.X.back().setZero();
    held.prior->aside.tail<3>().setConstant(1e12);
    BOOST_TEST_REQUIRE(window::levenberg_marquardt(held, {.tolerance = 1e-16}, workspace).ok);
    const double prior = 0.5 * std::pow(bias / kBiasSigma, 2);
    BOOST_TEST(std::abs((cost(held) + prior - best) / (0.5 * 0.2 * 0.2) - 1.0) < 0.02);
}

BOOST_AUTO_TEST_CASE(a_compressed_view_still_knows_of_the_bias) {
    const Scene scene = make_scene(kLandmarks, 6, 0.8, 0.5, 0.5, 23);
    window::Problem all = ranged(scene);
    window::Workspace workspace(all.landmarks());
    BOOST_TEST_REQUIRE(window::levenberg_marquardt(all, {.tolerance = 1e-14}, workspace).ok);
    const MatX S = information(all, workspace);
    window::Problem half = all;
    std::vector<Vec3> X_ref = scene.X_told;
    X_ref.emplace_back(Vec3::Zero());
    half.compressed.emplace_back(window::Reference{X_ref, window::Gauge::rigid, 1});
    for (std::size_t k = 3; k < 6; ++k) half.compressed.front().add(all.views[k], all.X);
    half.views.resize(3, window::ViewBlock(kLandmarks));
    BOOST_TEST((information(half, workspace) - S).norm() < 1e-6 * S.norm());
    BOOST_TEST(std::abs(cost(half) - cost(all)) < 1e-6 * cost(all));

    window::CompressedViews& views = half.compressed.front();
    std::vector<Vec3> X = all.X;
    X[3] += Vec3(0.1, -0.2, 0.05);
    X.back().x() += 0.4;
    views.linearise(X);
    const Eigen::Index b = 3 * kLandmarks;
    X.back().x() += 1e-4;
    const double forward = views.value(X);
    X.back().x() -= 2e-4;
    BOOST_TEST(std::abs(0.5 * (forward - views.value(X)) / 2e-4 - views.gradient()[b]) <
               1e-5 * views.gradient().norm());
    for (Vec3& x : X) x = so3::exp(Vec3(0.1, -0.2, 0.3)) * x + Vec3(5.0, -3.0, 2.0);
    X.back() = Vec3(all.X.back().x() + 0.4 - 1e-4, 0.0, 0.0);
    const double turned = views.value(X);
    BOOST_TEST(std::abs(turned - (forward - 2.0 * 2e-4 * views.gradient()[b])) < 1e-5 * std::abs(turned));
}
