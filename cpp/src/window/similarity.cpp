// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/similarity.hpp"

#include <Eigen/SVD>

#include "fairlead/geometry/so3.hpp"

namespace fairlead::window {
namespace {

Vec3 centroid(std::span<const Vec3> X) noexcept {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : X) sum += x;
    return sum / static_cast<double>(X.size());
}

}  // namespace

Similarity align(std::span<const Vec3> X, std::span<const Vec3> X_ref) noexcept {
    const Vec3 centre = centroid(X);
    const Vec3 centre_ref = centroid(X_ref);
    Mat33 C = Mat33::Zero();
    double spread_ref = 0.0;
    for (std::size_t j = 0; j < X.size(); ++j) {
        C += (X_ref[j] - centre_ref) * (X[j] - centre).transpose();
        spread_ref += (X_ref[j] - centre_ref).squaredNorm();
    }
    Similarity S;
    S.R = so3::nearest(C);
    S.s = spread_ref / (S.R.transpose() * C).trace();
    S.t = centre_ref - S.s * (S.R * centre);
    return S;
}

void gauge_basis(std::span<const Vec3> X, double radius, GaugeBasis& N) noexcept {
    const Vec3 centre = centroid(X);
    for (std::size_t j = 0; j < X.size(); ++j) {
        const Eigen::Index row = 3 * static_cast<Eigen::Index>(j);
        const Vec3 x = (X[j] - centre) / radius;
        N.block<3, 3>(row, 0).setIdentity();
        N.block<3, 3>(row, 3) = -so3::hat(x);
        N.block<3, 1>(row, 6) = x;
    }
}

}  // namespace fairlead::window
