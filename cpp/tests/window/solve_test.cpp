// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>

#include "fairlead/window/levenberg_marquardt.hpp"
#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

namespace {

double cost_at(window::Problem problem, const VecX& d) {
    const Eigen::Index n = 3 * problem.landmarks();
    for (std::size_t j = 0; j < problem.X.size(); ++j) problem.X[j] += d.segment<3>(3 * static_cast<Eigen::Index>(j));
    for (std::size_t k = 0; k < problem.views.size(); ++k) {
        SE3& T = problem.views[k].state.T_camera_target;
        T = perturb(T, d.segment<6>(n + 6 * static_cast<Eigen::Index>(k)));
    }
    BOOST_TEST_REQUIRE(window::linearise(problem));
    return window::posterior_cost(problem);
}

/// Gradient of E by central differences over all landmarks and poses.
VecX numeric_gradient(window::Problem& problem) {
    const Eigen::Index size = 3 * problem.landmarks() + 6 * static_cast<Eigen::Index>(problem.views.size());
    VecX gradient(size);
    for (Eigen::Index i = 0; i < size; ++i) {
        VecX d = VecX::Zero(size);
        d[i] = 1e-5;
        const double forward = cost_at(problem, d);
        d[i] = -1e-5;
        gradient[i] = (forward - cost_at(problem, d)) / 2e-5;
    }
    return gradient;
}

}  // namespace

BOOST_AUTO_TEST_CASE(reduced_gradient_is_the_gradient_with_the_states_eliminated) {
    const Scene scene = make_scene(8, 3, 0.6, 1.0, 1.0, 1);
    window::Problem problem = make_problem(scene, 1.0);
    problem.loss.threshold = 9.21;
    problem.noise_factor = 1.7;
    window::Workspace workspace(8);
    BOOST_TEST_REQUIRE(window::linearise(problem));
    BOOST_TEST_REQUIRE(window::assemble_data(problem, 0.0, workspace));
    window::scale_and_add_prior(problem, problem.X, workspace);

    VecX reduced = numeric_gradient(problem);
    for (std::size_t k = 0; k < problem.views.size(); ++k) {
        const window::ViewBlock& view = problem.views[k];
        const Vec6 g = reduced.segment<6>(24 + 6 * static_cast<Eigen::Index>(k));
        BOOST_TEST((g - view.g / 1.7).norm() < 1e-4 * (1.0 + g.norm()));
        for (std::size_t i = 0; i < view.terms.size(); ++i) {
            const int j = view.terms[i].landmark;
            const Eigen::Matrix<double, 3, 6> Yt =
                window::reduced_rows(view, view.terms[i], problem.X[static_cast<std::size_t>(j)]);
            reduced.segment<3>(3 * j) -= Yt * (view.L_inverse * g);
        }
    }
    BOOST_TEST((reduced.head(24) - workspace.g).norm() < 1e-4 * workspace.g.norm());
}

BOOST_AUTO_TEST_CASE(structure_system_is_the_schur_complement_of_the_full_hessian) {
    const Scene scene = make_scene(6, 4, 0.6, 1.0, 0.3, 2);
    window::Problem problem = make_problem(scene, 0.3);
    window::Workspace workspace(6);
    BOOST_TEST_REQUIRE(window::linearise(problem));
    BOOST_TEST_REQUIRE(window::assemble_data(problem, 0.0, workspace));
    window::scale_and_add_prior(problem, problem.X, workspace);

    MatX H = MatX::Zero(18 + 24, 18 + 24);
    H.topLeftCorner(18, 18) = problem.prior->information;
    for (std::size_t k = 0; k < 4; ++k) {
        const SE3& T = problem.views[k].state.T_camera_target;
        for (const window::Measurement& m : problem.views[k].measurements) {
            const Vec3& X = problem.X[static_cast<std::size_t>(m.landmark)];
            Vec2 z;
            Mat23 J;
            BOOST_TEST_REQUIRE(problem.camera.project(T * X, z, J));
            Eigen::Matrix<double, 2, Eigen::Dynamic> row = Eigen::Matrix<double, 2, Eigen::Dynamic>::Zero(2, 42);
            row.block<2, 3>(0, 3 * m.landmark) = J * T.R;
            row.block<2, 6>(0, 18 + 6 * static_cast<Eigen::Index>(k)) << J * T.R, -J * T.R * so3::hat(X);
            H += row.transpose() * m.information * row;
        }
    }
    const MatX schur = H.topLeftCorner(18, 18) - H.topRightCorner(18, 24) * H.bottomRightCorner(24, 24).ldlt().solve(
                                                                                MatX(H.bottomLeftCorner(24, 18)));
    const MatX S = workspace.S.selfadjointView<Eigen::Lower>();
    BOOST_TEST((S - schur).norm() < 1e-9 * schur.norm());
}

BOOST_AUTO_TEST_CASE(minimum_has_no_gradient_and_the_predicted_decrease_is_right) {
    const Scene scene = make_scene(20, 10, 1.5, 1.0, 1.0, 3);
    window::Problem problem = make_problem(scene, 1.0);
    window::Workspace workspace(20);
    const window::LmSummary summary = window::levenberg_marquardt(problem, {.tolerance = 1e-12}, workspace);
    BOOST_TEST(summary.ok);
    BOOST_TEST(summary.converged);
    BOOST_TEST(summary.cost < summary.initial_cost);
    BOOST_TEST(numeric_gradient(problem).cwiseAbs().maxCoeff() < 1e-2);
    // E at the optimum of a linear Gaussian problem is half a chi-square with (residuals - states) degrees of freedom.
    BOOST_TEST(std::abs(2.0 * summary.cost - (400.0 - 60.0)) < 4.0 * std::sqrt(2.0 * 340.0));
}

BOOST_AUTO_TEST_CASE(fixed_landmarks_stay_and_free_gauge_needs_no_prior) {
    Scene scene = make_scene(20, 6, 1.0, 0.5, 0.5, 4);
    window::Problem problem = make_problem(scene, 0.5);
    std::vector<Vec3> sigma(20, Vec3::Constant(0.5));
    sigma[3] = Vec3::Zero();
    problem.prior = window::make_prior(scene.X_told, window::landmark_covariance(scene.X_told, sigma, 0.0));
    window::Workspace workspace(20);
    BOOST_TEST(window::levenberg_marquardt(problem, {}, workspace).ok);
    BOOST_TEST((problem.X[3] - scene.X_told[3]).norm() < 1e-3);
    BOOST_TEST((problem.X[4] - scene.X_told[4]).norm() > 1e-3);

    window::Problem free = make_problem(scene, 0.5);
    free.prior.reset();
    const window::LmSummary summary = window::levenberg_marquardt(free, {}, workspace);
    BOOST_TEST(summary.ok);
    BOOST_TEST(summary.cost < summary.initial_cost);
}
