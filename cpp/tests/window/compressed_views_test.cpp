// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>

#include "fairlead/window/levenberg_marquardt.hpp"
#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

namespace {

std::vector<Vec3> transformed(const std::vector<Vec3>& X, double s, const Vec3& phi, const Vec3& t) {
    std::vector<Vec3> out;
    for (const Vec3& x : X) out.push_back(s * (so3::exp(phi) * x) + t);
    return out;
}

/// Compresses views at several, different models, as a tracker does while its model still moves.
window::CompressedViews compressed(const Scene& scene, std::mt19937_64& random) {
    window::CompressedViews sum({scene.X_told, window::Gauge::similarity});
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        std::vector<Vec3> X = transformed(scene.X_told, 1.0 + 0.01 * gaussian(random, 1.0).x(), gaussian(random, 0.02),
                                          gaussian(random, 1.0));
        for (Vec3& x : X) x += gaussian(random, 0.2);
        window::ViewBlock view(static_cast<int>(X.size()));
        view.state.T_camera_target = scene.T_true[k];
        for (const Observation& o : scene.views[k])
            view.measurements.push_back({o.landmark, o.z, o.covariance.inverse()});
        BOOST_TEST_REQUIRE(window::linearise(scene.camera, X, Loss{1e12}, 1.0, view));
        BOOST_TEST_REQUIRE(window::factor_state(0.0, view));
        sum.add(view, X);
    }
    return sum;
}

}  // namespace

BOOST_AUTO_TEST_CASE(value_is_invariant_under_every_similarity) {
    const Scene scene = make_scene(12, 5, 0.8, 1.0, 0.5, 5);
    std::mt19937_64 random(6);
    window::CompressedViews sum = compressed(scene, random);
    const double value = sum.value(scene.X_true);
    for (int i = 0; i < 20; ++i) {
        const auto moved = transformed(scene.X_true, std::exp(gaussian(random, 0.3).x()), gaussian(random, 0.8),
                                       gaussian(random, 50.0));
        BOOST_TEST(std::abs(sum.value(moved) - value) < 1e-8 * std::abs(value));
    }
}

BOOST_AUTO_TEST_CASE(hessian_has_the_null_space_of_the_model_it_is_taken_at) {
    const Scene scene = make_scene(12, 5, 0.8, 1.0, 0.5, 7);
    std::mt19937_64 random(8);
    window::CompressedViews sum = compressed(scene, random);
    const auto X = transformed(scene.X_true, 1.02, Vec3(0.05, -0.03, 0.1), Vec3(1.0, 2.0, 3.0));
    sum.linearise(X);
    window::GaugeBasis N(36, 7);
    window::gauge_basis(X, 70.0, N);
    BOOST_TEST((sum.hessian() * N).norm() < 1e-9 * sum.hessian().norm() * N.norm());
    BOOST_TEST((N.transpose() * sum.gradient()).norm() < 1e-9 * sum.gradient().norm() * N.norm());
    BOOST_TEST((sum.hessian() - sum.hessian().transpose()).norm() < 1e-9 * sum.hessian().norm());
    const Eigen::SelfAdjointEigenSolver<MatX> eigen(sum.hessian());
    BOOST_TEST(eigen.eigenvalues()[0] > -1e-9 * eigen.eigenvalues()[35]);
    BOOST_TEST(eigen.eigenvalues()[7] > 1e-6 * eigen.eigenvalues()[35]);
}

BOOST_AUTO_TEST_CASE(gradient_is_the_derivative_of_the_value) {
    const Scene scene = make_scene(9, 4, 0.8, 1.0, 0.5, 9);
    std::mt19937_64 random(10);
    window::CompressedViews sum = compressed(scene, random);
    const auto X = transformed(scene.X_true, 0.98, Vec3(0.05, -0.03, 0.1), Vec3(1.0, 2.0, 3.0));
    sum.linearise(X);
    const VecX gradient = sum.gradient();
    for (Eigen::Index i = 0; i < 27; ++i) {
        auto forward = X;
        auto backward = X;
        forward[static_cast<std::size_t>(i / 3)][i % 3] += 1e-4;
        backward[static_cast<std::size_t>(i / 3)][i % 3] -= 1e-4;
        const double numeric = 0.5 * (sum.value(forward) - sum.value(backward)) / 2e-4;
        BOOST_TEST(std::abs(numeric - gradient[i]) < 1e-5 * gradient.norm());
    }
}

BOOST_AUTO_TEST_CASE(a_compressed_view_is_the_view_at_the_model_it_was_taken_at) {
    const Scene scene = make_scene(12, 6, 0.8, 0.5, 0.5, 11);
    window::Problem all = make_problem(scene, 0.5);
    window::Workspace workspace(12);
    BOOST_TEST_REQUIRE(window::levenberg_marquardt(all, {.tolerance = 1e-14}, workspace).ok);
    BOOST_TEST_REQUIRE(window::assemble_data(all, 0.0, workspace));
    const MatX S = workspace.S.selfadjointView<Eigen::Lower>();

    window::Problem half = all;
    half.compressed.emplace_back(window::Reference{scene.X_told, window::Gauge::similarity});
    for (std::size_t k = 3; k < 6; ++k) half.compressed.front().add(all.views[k], all.X);
    half.views.resize(3, window::ViewBlock(12));
    BOOST_TEST_REQUIRE(window::linearise(half));
    BOOST_TEST_REQUIRE(window::assemble_data(half, 0.0, workspace));
    const MatX S_half = workspace.S.selfadjointView<Eigen::Lower>();
    BOOST_TEST((S_half - S).norm() < 1e-6 * S.norm());
    const double cost = window::posterior_cost(all);
    BOOST_TEST(std::abs(window::posterior_cost(half) - cost) < 1e-6 * cost);
}
