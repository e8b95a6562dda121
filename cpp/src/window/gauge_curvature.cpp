// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/gauge_curvature.hpp"

#include <Eigen/QR>
#include <array>
#include <vector>

#include "fairlead/geometry/so3.hpp"
#include "fairlead/window/similarity.hpp"

namespace fairlead::window {
namespace {

constexpr int kParameters = 4;  // rotation about x, y, z, and the logarithm of the scale
using Mat44 = Eigen::Matrix<double, kParameters, kParameters>;
using Generators = std::array<Mat33, kParameters>;

/// G_a with d(exp(theta) d) / d theta_a = G_a d at theta = 0.
Generators generators() {
    return {so3::hat(Vec3::UnitX()), so3::hat(Vec3::UnitY()), so3::hat(Vec3::UnitZ()), Mat33::Identity()};
}

/// Second derivatives of exp(theta) d, 3N x 16, column 4 a + b: 1/2 (G_a G_b + G_b G_a) d.
MatX second_derivatives(std::span<const Vec3> offsets, const Generators& G) {
    MatX H(3 * static_cast<Eigen::Index>(offsets.size()), kParameters * kParameters);
    for (std::size_t j = 0; j < offsets.size(); ++j)
        for (std::size_t a = 0; a < kParameters; ++a)
            for (std::size_t b = 0; b < kParameters; ++b)
                H.block<3, 1>(3 * static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(kParameters * a + b)) =
                    0.5 * (G[a] * G[b] + G[b] * G[a]) * offsets[j];
    return H;
}

}  // namespace

void add_gauge_curvature(std::span<const Vec3> X, MatX& Sigma) {
    const Eigen::Index n = static_cast<Eigen::Index>(X.size());
    GaugeBasis N(3 * n, 7);
    gauge_basis(X, 1.0, N);
    const MatX N_inverse = MatX(N).completeOrthogonalDecomposition().pseudoInverse();
    const Mat44 S = (N_inverse * Sigma * N_inverse.transpose()).bottomRightCorner<kParameters, kParameters>();
    const MatX A = MatX::Identity(3 * n, 3 * n) - N * N_inverse;
    const MatX shape = A * Sigma * A.transpose();

    const Generators G = generators();
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : X) centre += x / static_cast<double>(n);
    std::vector<Vec3> offsets(X.begin(), X.end());
    for (Vec3& d : offsets) d -= centre;
    const MatX H = second_derivatives(offsets, G);

    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
            for (std::size_t a = 0; a < kParameters; ++a) {
                Mat33 right = Mat33::Zero();
                for (std::size_t b = 0; b < kParameters; ++b)
                    right += S(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) * G[b].transpose();
                Sigma.block<3, 3>(3 * i, 3 * j) += G[a] * shape.block<3, 3>(3 * i, 3 * j) * right;
            }

    Eigen::Matrix<double, 16, 16> W;  // E of the product of two quadratics in theta, without the product of their means
    for (Eigen::Index p = 0; p < 16; ++p)
        for (Eigen::Index q = 0; q < 16; ++q) W(p, q) = 0.5 * S(p / 4, q / 4) * S(p % 4, q % 4);
    const VecX bias = 0.5 * H * S.reshaped();
    Sigma += H * W * H.transpose() + bias * bias.transpose();
    Sigma = (0.5 * (Sigma + Sigma.transpose())).eval();
}

}  // namespace fairlead::window
