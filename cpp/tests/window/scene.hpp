// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <vector>

#include "fairlead/window/problem.hpp"

namespace fairlead::testing {

/// A ship-sized cloud of landmarks seen from 1 km along an arc: true model, told model, views with noise.
struct Scene {
    Camera camera{.width = 1024, .height = 1024, .fx = 1910, .fy = 1910, .cx = 511.5, .cy = 511.5};
    std::vector<Vec3> X_true, X_told;
    std::vector<SE3> T_true;
    std::vector<std::vector<Observation>> views;
};

inline Vec3 gaussian(std::mt19937_64& random, double sigma) {
    std::normal_distribution<double> normal(0.0, sigma);
    const double x = normal(random);
    const double y = normal(random);
    return {x, y, normal(random)};
}

/// Camera at azimuth and elevation [rad] and range [m] looking at the target's middle, x right, y down, z forward.
inline SE3 look_at(double azimuth, double elevation, double range, const Vec3& middle) {
    const Vec3 forward(-std::cos(elevation) * std::cos(azimuth), -std::cos(elevation) * std::sin(azimuth),
                       -std::sin(elevation));
    const Vec3 right = forward.cross(Vec3::UnitZ()).normalized();
    SE3 T;
    T.R.row(0) = right.transpose();
    T.R.row(1) = forward.cross(right).transpose();
    T.R.row(2) = forward.transpose();
    T.t = -(T.R * (middle - range * forward));
    return T;
}

inline Scene make_scene(int landmarks, int views, double arc_rad, double sigma_px, double sigma_m, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::normal_distribution<double> pixel(0.0, sigma_px);
    Scene scene;
    for (int j = 0; j < landmarks; ++j) {
        const double x = unit(random), y = unit(random), z = unit(random);
        scene.X_true.emplace_back(70.0 + 70.0 * x, 9.0 * y, 16.0 + 16.0 * z);
        scene.X_told.push_back(scene.X_true.back() + gaussian(random, sigma_m));
    }
    for (int k = 0; k < views; ++k) {
        const double azimuth = 3.3 + arc_rad * (views > 1 ? static_cast<double>(k) / (views - 1) : 0.0);
        scene.T_true.push_back(look_at(azimuth, 0.26, 1000.0, Vec3(70.0, 0.0, 16.0)));
        std::vector<Observation> view;
        for (int j = 0; j < landmarks; ++j) {
            Vec2 z;
            if (!scene.camera.project(scene.T_true.back() * scene.X_true[static_cast<std::size_t>(j)], z)) continue;
            const double u = pixel(random);
            view.push_back({j, z + Vec2(u, pixel(random)), sigma_px * sigma_px * Mat22::Identity()});
        }
        scene.views.push_back(std::move(view));
    }
    return scene;
}

inline MatX independent_prior(const Scene& scene, double sigma_m) {
    return sigma_m * sigma_m *
           MatX::Identity(3 * static_cast<Eigen::Index>(scene.X_told.size()),
                          3 * static_cast<Eigen::Index>(scene.X_told.size()));
}

/// The batch problem of a scene, started from the true poses and the told model.
inline window::Problem make_problem(const Scene& scene, double sigma_m) {
    window::Problem problem;
    problem.camera = scene.camera;
    problem.prior = window::make_prior(scene.X_told, independent_prior(scene, sigma_m));
    problem.X = scene.X_told;
    problem.loss.threshold = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        window::ViewBlock view(static_cast<int>(scene.X_told.size()));
        view.state.T_camera_target = scene.T_true[k];
        for (const Observation& o : scene.views[k])
            view.measurements.push_back({o.landmark, o.z, o.covariance.inverse()});
        problem.views.push_back(std::move(view));
    }
    return problem;
}

}  // namespace fairlead::testing
