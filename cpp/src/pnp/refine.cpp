// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/pnp/refine.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "usable.hpp"

namespace fairlead::pnp {
namespace {

constexpr double kRankTolerance = 1e-12;  // smallest to largest pivot of the scaled information
constexpr double kConverged = 1e-10;      // predicted decrease, of the cost
constexpr double kFloor = 1e-20;          // and absolutely: beneath it the cost is rounding

/// What refine is given, with the target's origin moved to the observed centroid: far from it, H would be
/// ill-conditioned.
struct Task {
    std::span<const Vec3> X;
    std::span<const Observation> observations;
    const Camera& camera;
    const Loss& loss;
    Vec3 centroid = Vec3::Zero();
    double radius = 0.0;  // rms distance of the observed landmarks from it [m]
    int usable = 0;

    [[nodiscard]] double hidden_cost() const noexcept {
        return std::isfinite(loss.threshold) ? loss.bound() : kHiddenCost;
    }
};

struct Score {
    double cost = 0.0;
    int inliers = 0;
    int in_front = 0;
};

struct Normal {
    Mat66 H = Mat66::Zero();
    Vec6 g = Vec6::Zero();
};

bool prepare(Task& task) noexcept {
    double squares = 0.0;
    for (const Observation& observation : task.observations) {
        if (!is_usable(observation, task.X)) continue;
        task.centroid += task.X[static_cast<std::size_t>(observation.landmark)];
        ++task.usable;
    }
    if (task.usable < 3) return false;
    task.centroid /= task.usable;
    for (const Observation& observation : task.observations) {
        if (!is_usable(observation, task.X)) continue;
        squares += (task.X[static_cast<std::size_t>(observation.landmark)] - task.centroid).squaredNorm();
    }
    task.radius = std::sqrt(squares / task.usable);
    return std::isfinite(task.radius) && task.radius > 0.0;
}

Score score(const Task& task, const SE3& T) noexcept {
    Score total;
    for (const Observation& observation : task.observations) {
        if (!is_usable(observation, task.X)) continue;
        const Vec3 q = task.X[static_cast<std::size_t>(observation.landmark)] - task.centroid;
        Vec2 z;
        if (!task.camera.project(T * q, z)) {
            total.cost += task.hidden_cost();
            continue;
        }
        const double s = squared_residual(z - observation.z, observation.covariance);
        total.cost += task.loss.rho(s);
        total.inliers += s <= task.loss.threshold ? 1 : 0;
        ++total.in_front;
    }
    return total;
}

/// Normal equations at T, docs/pnp.md eq. (5): with B = J_pi R, M = w B^T S^-1 B and v = w B^T S^-1 r of each landmark.
Normal linearise(const Task& task, const SE3& T) noexcept {
    Normal normal;
    for (const Observation& observation : task.observations) {
        if (!is_usable(observation, task.X)) continue;
        const Vec3 q = task.X[static_cast<std::size_t>(observation.landmark)] - task.centroid;
        Vec2 z;
        Mat23 J;
        if (!task.camera.project(T * q, z, J)) continue;
        const Vec2 r = z - observation.z;
        const Mat22 S_inverse = observation.covariance.inverse();
        const double w = task.loss.weight(squared_residual(r, observation.covariance));
        const Mat23 B = J * T.R;
        const Mat23 WB = w * (S_inverse * B);
        const Mat33 M = B.transpose() * WB;
        const Vec3 v = WB.transpose() * r;
        const Mat33 A = so3::hat(q);
        const Mat33 AM = A * M;
        normal.H.topLeftCorner<3, 3>() += M;
        normal.H.bottomLeftCorner<3, 3>() += AM;
        normal.H.bottomRightCorner<3, 3>() -= AM * A;
        normal.g.head<3>() += v;
        normal.g.tail<3>() += A * v;
    }
    normal.H.topRightCorner<3, 3>() = normal.H.bottomLeftCorner<3, 3>().transpose();
    return normal;
}

/// Levenberg-Marquardt with Nielsen's damping (Madsen, Nielsen and Tingleff 2004, algorithm 3.16). The weighted
/// quadratic bounds the cost from above, because rho is concave in s, so its predicted decrease is the one to compare
/// with. Returns the iterations spent.
int minimise(const Task& task, int max_iterations, SE3& T, Score& current, Normal& normal) noexcept {
    double damping = 1e-4, growth = 2.0;
    for (int i = 0; i < max_iterations; ++i) {
        const Vec6 D = normal.H.diagonal().cwiseMax(std::numeric_limits<double>::min());
        Mat66 A = normal.H;
        A.diagonal() += damping * D;
        const Eigen::LLT<Mat66> llt(A);
        const Vec6 step = llt.solve(-normal.g);
        const double predicted = step.dot(damping * D.cwiseProduct(step) - normal.g);
        if (llt.info() != Eigen::Success || !std::isfinite(predicted)) return i;
        const SE3 trial = perturb(T, step);
        const Score next = score(task, trial);
        const double gain = (current.cost - next.cost) / predicted;
        const bool converged = predicted <= kConverged * current.cost + kFloor;
        if (gain > 0.0) {
            T = trial;
            current = next;
            normal = linearise(task, T);
            const double b = 2.0 * gain - 1.0;
            damping = std::max(1e-12, damping * std::max(1.0 / 3.0, 1.0 - b * b * b));
            growth = 2.0;
        } else {
            damping *= growth;
            growth *= 2.0;
        }
        if (converged) return i + 1;
    }
    return max_iterations;
}

/// Rotations measured by what they move at the target's radius, so that the pivots compare pixels with pixels.
bool full_rank(const Mat66& H, double radius) noexcept {
    Vec6 scale;
    scale << 1.0, 1.0, 1.0, 1.0 / radius, 1.0 / radius, 1.0 / radius;
    const Mat66 A = scale.asDiagonal() * H * scale.asDiagonal();
    if (!A.allFinite()) return false;
    const Vec6 pivots = A.ldlt().vectorD();
    return pivots.minCoeff() > kRankTolerance * pivots.maxCoeff();
}

/// xi about the target's origin instead of the centroid c: xi_c = [I, -hat(c); 0, I] xi.
Mat66 information_at_origin(const Mat66& H, const Vec3& c) noexcept {
    Mat66 A = Mat66::Identity();
    A.topRightCorner<3, 3>() = -so3::hat(c);
    const Mat66 information = A.transpose() * H * A;
    return 0.5 * (information + information.transpose());
}

}  // namespace

RefineResult refine(const SE3& T_start, std::span<const Vec3> X_target, std::span<const Observation> observations,
                    const Camera& camera, const Loss& loss, int max_iterations) noexcept {
    RefineResult result{.T_camera_target = T_start};
    Task task{.X = X_target, .observations = observations, .camera = camera, .loss = loss};
    if (!prepare(task) || !T_start.R.allFinite() || !T_start.t.allFinite()) return result;
    SE3 T{T_start.R, T_start * task.centroid};
    Score current = score(task, T);
    Normal normal = linearise(task, T);
    result.iterations = minimise(task, max_iterations, T, current, normal);
    T.R = so3::nearest(T.R);
    result.T_camera_target = {T.R, T.t - T.R * task.centroid};
    result.information = information_at_origin(normal.H, task.centroid);
    result.cost = current.cost;
    result.inliers = current.inliers;
    const bool least_squares = !std::isfinite(loss.threshold);
    const int needed = least_squares ? task.usable : std::max(3, (task.usable + 1) / 2);
    result.ok = current.in_front >= needed && T.t.z() > 0.0 && std::isfinite(current.cost) && T.R.allFinite() &&
                result.T_camera_target.t.allFinite() && result.information.allFinite() &&
                full_rank(normal.H, task.radius);
    return result;
}

}  // namespace fairlead::pnp
