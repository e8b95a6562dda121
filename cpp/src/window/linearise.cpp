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

/// H += E^T M E and g += E^T v with E = [I, -hat(X)].
void accumulate_state(const PointTerm& term, const Vec3& X, StateMatrix& H, StateVector& g) noexcept {
    const Mat33 XM = so3::hat(X) * term.M;  // -(E^T M) lower half has the sign of hat(X) M
    H.topLeftCorner<3, 3>() += term.M;
    H.bottomLeftCorner<3, 3>() += XM;
    H.bottomRightCorner<3, 3>() -= XM * so3::hat(X);
    g.head<3>() += term.v;
    g.tail<3>() += X.cross(term.v);
}

}  // namespace

bool linearise(const Camera& camera, std::span<const Vec3> X_target, const Loss& loss, ViewBlock& view) noexcept {
    view.H.setZero();
    view.g.setZero();
    view.cost = view.weighted_squares = view.weights = 0.0;
    view.terms.resize(view.measurements.size());
    const SE3& T = view.state.T_camera_target;
    int visible = 0;
    for (std::size_t i = 0; i < view.measurements.size(); ++i) {
        const Measurement& measurement = view.measurements[i];
        const Vec3& X = X_target[static_cast<std::size_t>(measurement.landmark)];
        PointTerm& term = view.terms[i];
        Vec2 z;
        Mat23 J;
        if (!camera.project(T * X, z, J)) {
            term = PointTerm{};
            view.cost += hidden_cost(loss);
            continue;
        }
        const Vec2 r = z - measurement.z;
        const Vec2 weighted = measurement.information * r;
        const double s = r.dot(weighted);
        const double w = loss.weight(s);
        const Mat23 B = J * T.R;
        const Mat23 SB = w * (measurement.information * B);
        term.M.noalias() = B.transpose() * SB;
        term.v.noalias() = w * (B.transpose() * weighted);
        accumulate_state(term, X, view.H, view.g);
        view.cost += loss.rho(s);
        view.weighted_squares += w * s;
        view.weights += w;
        ++visible;
    }
    view.H.topRightCorner<3, 3>() = view.H.bottomLeftCorner<3, 3>().transpose();
    return visible >= 3 && std::isfinite(view.cost) && view.H.allFinite();
}

double view_cost(const Camera& camera, std::span<const Vec3> X_target, const Loss& loss, const SE3& T_camera_target,
                 const ViewBlock& view) noexcept {
    double cost = 0.0;
    for (const Measurement& measurement : view.measurements) {
        Vec2 z;
        if (!camera.project(T_camera_target * X_target[static_cast<std::size_t>(measurement.landmark)], z)) {
            cost += hidden_cost(loss);
            continue;
        }
        const Vec2 r = z - measurement.z;
        cost += loss.rho(r.dot(measurement.information * r));
    }
    return cost;
}

}  // namespace fairlead::window
