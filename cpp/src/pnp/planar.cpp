// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/pnp/planar.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

#include "usable.hpp"

namespace fairlead::pnp {
namespace {

constexpr int kPairIterations = 50;   // the second minimum is shallow
constexpr double kSameMinimum = 1.0;  // squared Mahalanobis distance [-] below which two poses are one

/// Centroid and principal axes of the observed landmarks, least extent first.
struct PrincipalAxes {
    Vec3 centroid = Vec3::Zero();
    Vec3 variances = Vec3::Zero();  // [m^2]
    Mat33 axes = Mat33::Identity();
};

PrincipalAxes principal_axes(std::span<const Vec3> X, std::span<const Observation> observations) noexcept {
    PrincipalAxes result;
    int count = 0;
    for (const Observation& o : observations) {
        if (!is_usable(o, X)) continue;
        result.centroid += X[static_cast<std::size_t>(o.landmark)];
        ++count;
    }
    if (count == 0) return result;
    result.centroid /= count;
    Mat33 scatter = Mat33::Zero();
    for (const Observation& o : observations) {
        if (!is_usable(o, X)) continue;
        const Vec3 x = X[static_cast<std::size_t>(o.landmark)] - result.centroid;
        scatter += x * x.transpose() / count;
    }
    if (!scatter.allFinite()) return result;
    const Eigen::SelfAdjointEigenSolver<Mat33> eigen(scatter);
    result.variances = eigen.eigenvalues().cwiseMax(0.0);
    result.axes = eigen.eigenvectors();
    return result;
}

Mat33 reflection(const Vec3& normal) noexcept { return Mat33::Identity() - 2.0 * normal * normal.transpose(); }

}  // namespace

SE3 mirrored(const SE3& T_camera_target, std::span<const Vec3> X_target,
             std::span<const Observation> observations) noexcept {
    const PrincipalAxes principal = principal_axes(X_target, observations);
    const Vec3 middle = T_camera_target * principal.centroid;
    SE3 T;
    T.R = reflection(middle.stableNormalized()) * T_camera_target.R * reflection(principal.axes.col(0));
    T.t = middle - T.R * principal.centroid;
    return T;
}

PosePair pose_pair(const SE3& T_start, std::span<const Vec3> X_target, std::span<const Observation> observations,
                   const Camera& camera, const Loss& loss) noexcept {
    PosePair pair;
    pair.best = refine(T_start, X_target, observations, camera, loss, kPairIterations);
    const SE3& T_first = pair.best.ok ? pair.best.T_camera_target : T_start;
    pair.other =
        refine(mirrored(T_first, X_target, observations), X_target, observations, camera, loss, kPairIterations);
    if (pair.other.ok && (!pair.best.ok || pair.other.cost < pair.best.cost)) std::swap(pair.best, pair.other);
    if (!pair.best.ok || !pair.other.ok) return pair;
    const Vec6 xi = difference(pair.best.T_camera_target, pair.other.T_camera_target);
    pair.distinct = xi.dot(pair.best.information * xi) > kSameMinimum;
    return pair;
}

Spread spread(std::span<const Vec3> X_target, std::span<const Observation> observations) noexcept {
    const Vec3 extent = principal_axes(X_target, observations).variances.cwiseSqrt();
    if (!(extent[2] > 0.0)) return {};
    return {.flatness = extent[1] > 0.0 ? extent[0] / extent[1] : 0.0, .straightness = extent[1] / extent[2]};
}

}  // namespace fairlead::pnp
