// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/geometry/types.hpp"

namespace fairlead::window {

/// y = s R X + t.
struct Similarity {
    double s = 1.0;
    Mat33 R = Mat33::Identity();
    Vec3 t = Vec3::Zero();
};

/// The similarity that brings X onto the slice of X_ref: rotation and translation by least squares (Umeyama 1991, eq.
/// (40)-(41)), scale such that sum x_ref . y = sum x_ref . x_ref about the centroids; then N(X_ref)^T (y - X_ref) = 0
/// exactly, docs/estimator.md eq. (12).
[[nodiscard]] Similarity align(std::span<const Vec3> X, std::span<const Vec3> X_ref) noexcept;

using GaugeBasis = Eigen::Matrix<double, Eigen::Dynamic, 7>;

/// N(X): the seven directions of the model that images cannot see: translation, rotation and scale about the centroid,
/// in metres of the model's radius (rotation and scale columns divided by it). Writes 3N x 7.
void gauge_basis(std::span<const Vec3> X, double radius, GaugeBasis& N) noexcept;

}  // namespace fairlead::window
