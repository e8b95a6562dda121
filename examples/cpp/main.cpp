// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
//
// A camera approaches a docking port. Ten points of the port were measured by hand, 5 cm wrong each; the detector is
// 0.5 px wrong. The tracker is told just that. Printed: where the port is, how sure that is, and how wrong the model is
// by now.

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <fairlead/tracker.hpp>
#include <fairlead/window/landmark_prior.hpp>
#include <random>
#include <vector>

using fairlead::Mat22;
using fairlead::Mat33;
using fairlead::SE3;
using fairlead::Vec2;
using fairlead::Vec3;

namespace {

constexpr double kModelSigma = 0.05;  // [m]
constexpr double kPixelSigma = 0.5;   // [px]
constexpr int kViews = 200;

std::vector<Vec3> port() {
    return {{-1.0, -0.8, 0.0}, {1.0, -0.8, 0.1}, {1.1, 0.8, 0.0},  {-0.9, 0.8, -0.1}, {0.0, 0.0, 0.6},
            {0.4, -0.3, 0.5},  {-0.4, 0.4, 0.4}, {0.7, 0.2, -0.4}, {-0.7, -0.1, 0.3}, {0.1, 0.9, -0.5}};
}

Vec3 noise(std::mt19937_64& random, double sigma) {
    std::normal_distribution<double> normal(0.0, sigma);
    return {normal(random), normal(random), normal(random)};
}

/// From 12 m to 4 m on a quarter of a turn, the camera always looking at the port: p_camera = T_camera_target *
/// X_target.
SE3 approach(int k) {
    const double share = static_cast<double>(k) / (kViews - 1);
    SE3 T_camera_target = SE3::exp((fairlead::Vec6() << 0.0, 0.0, 0.0, 0.4, 1.5 * share - 0.75, 0.0).finished());
    T_camera_target.t = Vec3(0.2, -0.1, 12.0 - 8.0 * share);
    return T_camera_target;
}

/// Error of the shape [m rms]: what remains when position, attitude and size, which no image shows, are taken off.
double shape_error(std::span<const Vec3> X, std::span<const Vec3> X_true) {
    const auto n = static_cast<Eigen::Index>(X.size());
    const Eigen::Map<const Eigen::Matrix3Xd> from(X.front().data(), 3, n);
    const Eigen::Map<const Eigen::Matrix3Xd> to(X_true.front().data(), 3, n);
    const Eigen::Matrix4d T_true_model = Eigen::umeyama(from, to);
    const Eigen::Matrix3Xd error = (T_true_model.topRows<3>() * from.colwise().homogeneous()) - to;
    return error.norm() / std::sqrt(static_cast<double>(n));
}

}  // namespace

int main() {
    std::mt19937_64 random(1);
    const std::vector<Vec3> X_true = port();
    std::vector<Vec3> X0 = X_true;
    for (Vec3& X : X0) X += noise(random, kModelSigma);

    const Mat33 K = (Mat33() << 800.0, 0.0, 319.5, 0.0, 800.0, 239.5, 0.0, 0.0, 1.0).finished();
    const fairlead::Camera camera = fairlead::make_camera(fairlead::CameraModel::pinhole, 640, 480, K, {});
    const std::vector<Vec3> sigma(X0.size(), Vec3::Constant(kModelSigma));
    fairlead::Tracker tracker(camera, X0, fairlead::window::landmark_covariance(X0, sigma, 0.0));

    fairlead::Estimate estimate;
    for (int k = 0; k < kViews; ++k) {
        std::vector<fairlead::Observation> view;
        for (std::size_t j = 0; j < X_true.size(); ++j) {
            Vec2 z;
            if (!camera.project(approach(k) * X_true[j], z)) continue;
            z += noise(random, kPixelSigma).head<2>();
            view.push_back({static_cast<int>(j), z, kPixelSigma * kPixelSigma * Mat22::Identity()});
        }
        estimate = tracker.update(std::int64_t{50'000'000} * k, view);
        if (k % 40 != 0 && k != kViews - 1) continue;
        const Vec3 t = estimate.T_camera_target.t;
        std::printf("view %3d  %s  t = (%.3f %.3f %.3f) m  1 sigma %.3f m  error %.3f m  shape %.1f mm\n", k,
                    fairlead::to_string(estimate.status), t.x(), t.y(), t.z(),
                    std::sqrt(estimate.covariance.topLeftCorner<3, 3>().trace()), (t - approach(k).t).norm(),
                    1e3 * shape_error(tracker.landmarks(), X_true));
    }
    return estimate.ok() && shape_error(tracker.landmarks(), X_true) < 0.2 * shape_error(X0, X_true) ? 0 : 1;
}
