// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/gauge_curvature.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <random>

#include "fairlead/geometry/so3.hpp"

using namespace fairlead;

namespace {

/// A ship-sized cloud.
std::vector<Vec3> cloud() {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Vec3> X;
    for (int j = 0; j < 20; ++j) X.emplace_back(70.0 * unit(random), 9.0 * unit(random), 16.0 * unit(random));
    return X;
}

}  // namespace

/// Models drawn by turning, scaling and then shaking the shape have the covariance that is reported, about the model.
BOOST_AUTO_TEST_CASE(covariance_is_that_of_models_drawn_along_the_gauge) {
    const std::vector<Vec3> X = cloud();
    const Vec3 sigma_rotation(0.05, 0.01, 0.01);
    const double sigma_scale = 0.01, sigma_shape = 0.01;
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(X.size());
    std::mt19937_64 random(6);
    std::normal_distribution<double> normal;
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : X) centre += x / static_cast<double>(X.size());

    MatX linear = sigma_shape * sigma_shape * MatX::Identity(n, n);
    for (std::size_t i = 0; i < X.size(); ++i)
        for (std::size_t j = 0; j < X.size(); ++j) {
            const Vec3 a = X[i] - centre, b = X[j] - centre;
            linear.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j)) +=
                so3::hat(a) * sigma_rotation.cwiseAbs2().asDiagonal() * so3::hat(b).transpose() +
                sigma_scale * sigma_scale * a * b.transpose();
        }
    MatX reported = linear;
    window::add_gauge_curvature(X, reported);

    MatX drawn = MatX::Zero(n, n);
    constexpr int kDraws = 20000;
    for (int draw = 0; draw < kDraws; ++draw) {
        const Vec3 theta = sigma_rotation.cwiseProduct(Vec3(normal(random), normal(random), normal(random)));
        const Mat33 sR = std::exp(sigma_scale * normal(random)) * so3::exp(theta);
        VecX error(n);
        for (std::size_t j = 0; j < X.size(); ++j) {
            const Vec3 shake = sigma_shape * Vec3(normal(random), normal(random), normal(random));
            error.segment<3>(3 * static_cast<Eigen::Index>(j)) = centre + sR * (X[j] + shake - centre) - X[j];
        }
        drawn.noalias() += error * error.transpose() / kDraws;
    }
    // Whitened by what is reported, the draws are white in every direction; by the linear covariance they are not.
    const auto widest = [&](const MatX& P) {
        const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> eigen(drawn, P);
        return eigen.eigenvalues().maxCoeff();
    };
    BOOST_TEST(widest(reported) < 1.2);
    BOOST_TEST(widest(linear) > 1.4);
}
