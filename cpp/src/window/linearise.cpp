// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/linearise.hpp"

#include <cmath>
#include <limits>

namespace fairlead::window {
namespace {

double hidden_cost(const Loss& loss) noexcept {
    return std::isinf(loss.threshold) ? std::numeric_limits<double>::infinity() : 2.0 * loss.threshold;
}

/// H += E^T M E, but for its upper right block, and g += E^T v with E = [I, -hat(X)].
void accumulate_state(const PointTerm& term, const Vec3& X, StateMatrix& H, StateVector& g) noexcept {
    const Mat33 MX = so3::times_hat(term.M, X);
    H.topLeftCorner<3, 3>() += term.M;
    H.bottomLeftCorner<3, 3>() -= MX.transpose();
    H.bottomRightCorner<3, 3>() += so3::times_hat(MX.transpose(), X);
    g.head<3>() += term.v;
    g.tail<3>() += X.cross(term.v);
}

double range_residual(std::span<const Vec3> X_target, const RangeMeasurement& m, const Vec3& p) noexcept {
    return p.norm() + (m.bias < 0 ? 0.0 : X_target[static_cast<std::size_t>(m.bias)].x()) - m.range_m;
}

/// A range is a term of rank one. Its sigma is in metres and no part of the estimated noise of the pixels: `told` turns
/// it into their units. It is believed: what to believe was decided by other readings, not by a pose that may be far
/// off still.
void linearise_ranges(std::span<const Vec3> X_target, double told, ViewBlock& view) noexcept {
    const SE3& T = view.state.T_camera_target;
    view.range_squares = 0.0;
    for (std::size_t i = 0; i < view.ranges.size(); ++i) {
        const RangeMeasurement& measurement = view.ranges[i];
        const Vec3& X = X_target[static_cast<std::size_t>(measurement.landmark)];
        const Vec3 p = T * X;
        const double information = told / (measurement.sigma_m * measurement.sigma_m);
        const double r = range_residual(X_target, measurement, p);
        const Vec3 B = T.R.transpose() * p.normalized();
        PointTerm& term = view.terms[view.measurements.size() + i];
        term = {measurement.landmark, information * B * B.transpose(), information * r * B, measurement.bias, B};
        accumulate_state(term, X, view.H, view.g);
        view.range_squares += information * r * r;
    }
    view.cost += view.range_squares;
}

double range_cost(std::span<const Vec3> X_target, double told, const SE3& T, const ViewBlock& view) noexcept {
    double cost = 0.0;
    for (const RangeMeasurement& m : view.ranges) {
        const Vec3 p = T * X_target[static_cast<std::size_t>(m.landmark)];
        cost += told * std::pow(range_residual(X_target, m, p) / m.sigma_m, 2);
    }
    return cost;
}

}  // namespace

bool linearise(const Camera& camera, std::span<const Vec3> X_target, const Loss& loss, double noise_factor,
               ViewBlock& view) noexcept {
    view.H.setZero();
    view.g.setZero();
    view.cost = view.inlier_squares = view.inliers = 0.0;
    view.terms.resize(view.measurements.size() + view.ranges.size());
    const SE3& T = view.state.T_camera_target;
    int visible = 0;
    for (std::size_t i = 0; i < view.measurements.size(); ++i) {
        const Measurement& measurement = view.measurements[i];
        const Vec3& X = X_target[static_cast<std::size_t>(measurement.landmark)];
        PointTerm& term = view.terms[i];
        Vec2 z;
        Mat23 J;
        if (!camera.project(T * X, z, J)) {
            term = PointTerm{.landmark = measurement.landmark};
            view.cost += view.share * hidden_cost(loss);
            continue;
        }
        const Vec2 r = z - measurement.z;
        const Vec2 weighted = measurement.information * r;
        const double s = r.dot(weighted);
        const double w = loss.weight(s);
        const Mat23 B = J * T.R;
        const Mat23 SB = view.share * w * (measurement.information * B);
        term.landmark = measurement.landmark;
        term.M.noalias() = B.transpose() * SB;
        term.v.noalias() = SB.transpose() * r;
        accumulate_state(term, X, view.H, view.g);
        view.cost += view.share * loss.rho(s);
        if (s <= loss.threshold) {
            view.inlier_squares += view.share * s;
            view.inliers += view.share;
        }
        ++visible;
    }
    linearise_ranges(X_target, noise_factor, view);
    view.H.topRightCorner<3, 3>() = view.H.bottomLeftCorner<3, 3>().transpose();
    return visible >= 3 && std::isfinite(view.cost) && view.H.allFinite();
}

double view_cost(const Camera& camera, std::span<const Vec3> X_target, const Loss& loss, double noise_factor,
                 const SE3& T_camera_target, const ViewBlock& view) noexcept {
    double cost = range_cost(X_target, noise_factor, T_camera_target, view);
    for (const Measurement& measurement : view.measurements) {
        Vec2 z;
        if (!camera.project(T_camera_target * X_target[static_cast<std::size_t>(measurement.landmark)], z)) {
            cost += view.share * hidden_cost(loss);
            continue;
        }
        const Vec2 r = z - measurement.z;
        cost += view.share * loss.rho(r.dot(measurement.information * r));
    }
    return cost;
}

}  // namespace fairlead::window
