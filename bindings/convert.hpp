// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// numpy <-> the core's types. Shapes are checked by the array types; what they cannot say is checked here.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <Eigen/LU>
#include <limits>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "fairlead/pnp/observation.hpp"

namespace fairlead::bindings {

namespace nb = nanobind;

template <typename... Shape>
using Array = nb::ndarray<const double, Shape..., nb::c_contig, nb::device::cpu>;
using Rows2 = Array<nb::shape<-1, 2>>;
using Rows3 = Array<nb::shape<-1, 3>>;
using Rows22 = Array<nb::shape<-1, 2, 2>>;
using Rows44 = Array<nb::shape<-1, 4, 4>>;
using Pose = Array<nb::shape<4, 4>>;
using Square = Array<nb::shape<-1, -1>>;
using Vector = Array<nb::shape<-1>>;
using Indices = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Indices64 = nb::ndarray<const std::int64_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline std::vector<Vec3> to_points(const Rows3& rows) {
    std::vector<Vec3> points(rows.shape(0));
    for (std::size_t j = 0; j < points.size(); ++j) points[j] = Eigen::Map<const Vec3>(rows.data() + 3 * j);
    return points;
}

inline MatX to_matrix(const Square& square) {
    return Eigen::Map<const RowMajor>(square.data(), static_cast<Eigen::Index>(square.shape(0)),
                                      static_cast<Eigen::Index>(square.shape(1)));
}

/// Row-major 4x4 numbers as a rigid motion; `name` is how an error calls them.
inline SE3 to_pose(const double* numbers, const std::string& name) {
    const Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers);
    const Mat33 R = T.topLeftCorner<3, 3>();
    const bool rigid = T.allFinite() && (R * R.transpose()).isIdentity(1e-6) && R.determinant() > 0.0 &&
                       T.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
    if (!rigid) {
        std::ostringstream got;
        got << T.format(Eigen::IOFormat(6, Eigen::DontAlignCols, " ", "; ", "", "", "[", "]"));
        throw std::invalid_argument(name + ": expected a rigid motion [R t; 0 0 0 1], got " + got.str());
    }
    return {so3::nearest(R), T.topRightCorner<3, 1>()};
}

inline SE3 to_pose(const Rows44& poses, std::size_t k) {
    return to_pose(poses.data() + 16 * k, "T block " + std::to_string(k));
}

inline std::vector<Observation> to_observations(const Indices& landmarks, const Rows2& pixels,
                                                const Rows22& covariances) {
    const std::size_t n = landmarks.size();
    if (pixels.shape(0) != n || covariances.shape(0) != n)
        throw std::invalid_argument("observations: got " + std::to_string(n) + " landmarks, " +
                                    std::to_string(pixels.shape(0)) + " pixels and " +
                                    std::to_string(covariances.shape(0)) + " covariances, expected as many of each");
    std::vector<Observation> observations(n);
    for (std::size_t i = 0; i < n; ++i) {
        observations[i].landmark = landmarks.data()[i];
        observations[i].z = Eigen::Map<const Vec2>(pixels.data() + 2 * i);
        observations[i].covariance =
            Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(covariances.data() + 4 * i);
    }
    return observations;
}

inline Eigen::Matrix4d matrix(const SE3& T) {
    Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
    M.topLeftCorner<3, 3>() = T.R;
    M.topRightCorner<3, 1>() = T.t;
    if (!T.t.allFinite()) M.setConstant(std::numeric_limits<double>::quiet_NaN());
    return M;
}

/// A new array that owns its data.
inline nb::ndarray<nb::numpy, double> to_array(const MatX& M) {
    auto* data = new double[static_cast<std::size_t>(M.size())];
    Eigen::Map<RowMajor>(data, M.rows(), M.cols()) = M;
    const nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    return {data, {static_cast<std::size_t>(M.rows()), static_cast<std::size_t>(M.cols())}, owner};
}

inline nb::ndarray<nb::numpy, double> to_array(std::span<const Vec3> X) {
    RowMajor M(static_cast<Eigen::Index>(X.size()), 3);
    for (std::size_t j = 0; j < X.size(); ++j) M.row(static_cast<Eigen::Index>(j)) = X[j].transpose();
    return to_array(MatX(M));
}

}  // namespace fairlead::bindings
