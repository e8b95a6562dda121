// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "fairlead/geometry/se3.hpp"
#include "fairlead/pnp/observation.hpp"

namespace fairlead::window {

/// What is unknown of one view: its pose. A motion prior would append velocity and acceleration here, and kDim grows
/// with it.
struct ViewState {
    static constexpr int kDim = 6;
    SE3 T_camera_target;
};

using StateVector = Eigen::Matrix<double, ViewState::kDim, 1>;
using StateMatrix = Eigen::Matrix<double, ViewState::kDim, ViewState::kDim>;
using StateByPoint = Eigen::Matrix<double, 3, ViewState::kDim>;

/// An observation ready for the solver: covariance inverted once.
struct Measurement {
    int landmark = -1;
    Vec2 z = Vec2::Zero();
    Mat22 information = Mat22::Identity();  ///< S^-1 [1/px^2]
};

/// A measured distance from the camera to a landmark, |T X_j|, and what the range finder always reads too much.
struct RangeMeasurement {
    int landmark = -1;
    double range_m = 0.0;
    double sigma_m = 1.0;
    int bias = -1;  ///< where in X that is, as its first coordinate; -1: nowhere, it is right
};

/// One measurement of a landmark linearised at (T, X): whatever it measures, it depends on T X_j alone, so that B = d h
/// / d X_target is all there is to know, docs/estimator.md eq. (5).
struct PointTerm {
    int landmark = -1;
    Mat33 M = Mat33::Zero();    ///< w B^T S^-1 B, the landmark's own information
    Vec3 v = Vec3::Zero();      ///< w B^T S^-1 r, the gradient with respect to the landmark
    int bias = -1;              ///< of a range: a metre of it is like a metre of the landmark along the line of sight
    Vec3 along = Vec3::Zero();  ///< which is this, in the target frame
};

/// One view: state, measurements, and their linearisation. Sized once; never grows beyond the number of landmarks.
struct ViewBlock {
    static constexpr std::size_t kMaxRanges = 4;

    std::int64_t stamp_ns = 0;
    ViewState state;
    std::vector<Measurement> measurements;

    std::vector<RangeMeasurement> ranges;
    double share = 1.0;  ///< of what an independent view would say: less where errors are alike in neighbouring views

    std::vector<PointTerm> terms;                 ///< one per measurement, pixels first
    StateMatrix H = StateMatrix::Zero();          ///< Hessian of the state alone
    StateVector g = StateVector::Zero();          ///< its gradient
    StateMatrix L_inverse = StateMatrix::Zero();  ///< inverse Cholesky factor of the (damped) H
    double cost = 0.0;                            ///< sum rho(s), ranges included
    double inlier_squares = 0.0;                  ///< sum s, over the pixels with s <= a
    double inliers = 0.0;                         ///< their number; both times `share`
    double range_squares = 0.0;                   ///< sum s, over the ranges

    explicit ViewBlock(int max_landmarks = 0) {
        measurements.reserve(static_cast<std::size_t>(max_landmarks));
        ranges.reserve(kMaxRanges);
        terms.reserve(static_cast<std::size_t>(max_landmarks) + kMaxRanges);
    }
};

/// The camera's position in the target frame, -R^T t [m].
[[nodiscard]] inline Vec3 camera_centre(const SE3& T_camera_target) noexcept {
    return -(T_camera_target.R.transpose() * T_camera_target.t);
}

}  // namespace fairlead::window
