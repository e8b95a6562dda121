// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/observability.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

#include "fairlead/window/eliminate.hpp"
#include "fairlead/window/linearise.hpp"
#include "fairlead/window/similarity.hpp"

namespace fairlead::window {

GaugeSigma gauge_sigma(std::span<const Vec3> X, const MatX& Sigma) {
    GaugeBasis N(3 * static_cast<Eigen::Index>(X.size()), 7);
    gauge_basis(X, 1.0, N);
    const MatX inverse = MatX(N).completeOrthogonalDecomposition().pseudoInverse();
    const VecX sigma = (inverse * Sigma * inverse.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
    return {sigma.head<3>(), sigma.segment<3>(3), sigma[6]};
}

double predicted_gain(const Camera& camera, std::span<const Vec3> X, const MatX& Sigma, const SE3& T_camera_target,
                      double sigma_px) {
    const int n = static_cast<int>(X.size());
    ViewBlock view(n);
    view.state.T_camera_target = T_camera_target;
    for (int j = 0; j < n; ++j) {
        Vec2 z;
        if (camera.project(T_camera_target * X[static_cast<std::size_t>(j)], z))
            view.measurements.push_back({j, z, Mat22::Identity() / (sigma_px * sigma_px)});
    }
    if (!linearise(camera, X, Loss{}, 1.0, view) || !factor_state(0.0, view)) return 0.0;
    MatX A = MatX::Zero(3 * n, 3 * n);
    VecX g = VecX::Zero(3 * n);
    Eliminator eliminator(n);
    eliminator.add(view, X, A, g);
    eliminator.flush(A);
    const MatX gain = MatX::Identity(3 * n, 3 * n) + Sigma * MatX(A.selfadjointView<Eigen::Lower>());
    return 0.5 * std::log(std::max(1.0, gain.determinant()));
}

}  // namespace fairlead::window
