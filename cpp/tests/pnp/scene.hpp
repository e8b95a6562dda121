// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "check.hpp"
#include "fairlead/pnp/refine.hpp"

namespace fairlead::testing {

inline Camera pinhole() { return {.width = 1024, .height = 1024, .fx = 1910, .fy = 1900, .cx = 511.5, .cy = 507.0}; }

/// A target of size 1, seen once.
struct Scene {
    Camera camera = pinhole();
    std::vector<Vec3> X;
    std::vector<Observation> observations;
    SE3 T;
};

inline Mat22 random_covariance(Random& random, double sigma) {
    Mat22 A;
    A << random.normal(), random.normal(), random.normal(), random.normal();
    return sigma * sigma * (0.3 * A * A.transpose() + 0.5 * Mat22::Identity());
}

/// n landmarks in a box of half sides `box`, at about `range`, in front and in the image's middle half; noise as the
/// covariances say.
inline Scene make_scene(Random& random, int n, const Vec3& box, double range, double sigma_px,
                        const Camera& camera = pinhole()) {
    Scene scene{.camera = camera, .X = {}, .observations = {}, .T = {}};
    for (int j = 0; j < n; ++j)
        scene.X.emplace_back(random.uniform(-1, 1) * box.x(), random.uniform(-1, 1) * box.y(),
                             random.uniform(-1, 1) * box.z());
    scene.T = {random.rotation(), Vec3(random.uniform(-0.1, 0.1) * range, random.uniform(-0.1, 0.1) * range, range)};
    for (int j = 0; j < n; ++j) {
        Observation o{.landmark = j, .covariance = random_covariance(random, sigma_px > 0.0 ? sigma_px : 1.0)};
        BOOST_TEST_REQUIRE(camera.project(scene.T * scene.X[static_cast<std::size_t>(j)], o.z));
        const double a = std::sqrt(o.covariance(0, 0)), b = o.covariance(0, 1) / a;
        const Vec2 e = random.vector<2>();
        if (sigma_px > 0.0) o.z += Vec2(a * e.x(), b * e.x() + std::sqrt(o.covariance(1, 1) - b * b) * e.y());
        scene.observations.push_back(o);
    }
    return scene;
}

/// Puts the first `count` observations anywhere in the image.
inline void spoil(Scene& scene, Random& random, int count) {
    for (int i = 0; i < count; ++i)
        scene.observations[static_cast<std::size_t>(i)].z = {random.uniform(0, 1024), random.uniform(0, 1024)};
}

inline double rotation_error(const SE3& a, const SE3& b) { return difference(a, b).tail<3>().norm(); }
inline double position_error(const SE3& a, const SE3& b) { return (a.t - b.t).norm() / b.t.norm(); }

inline bool is_finite(const pnp::RefineResult& r) {
    return r.T_camera_target.R.allFinite() && r.T_camera_target.t.allFinite() && r.information.allFinite() &&
           std::isfinite(r.cost);
}

}  // namespace fairlead::testing
