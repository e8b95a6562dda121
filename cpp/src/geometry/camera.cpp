// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/geometry/camera.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>
#include <string>

#include "distortion.hpp"

namespace fairlead {
namespace {

/// r with distorted_radius(r) = d, by bisection on the monotonic part and Newton's steps where they stay inside.
/// Negative if there is none.
double ideal_radius(const Camera& camera, double d) noexcept {
    double low = 0.0, high = camera.radius_limit;
    if (!(d <= distortion::distorted_radius(camera, high))) return -1.0;
    double r = std::min(d, high);
    for (int i = 0; i < 100; ++i) {
        const double error = distortion::distorted_radius(camera, r) - d;
        (error > 0.0 ? high : low) = r;
        if (std::abs(error) <= 1e-10 * d || high - low <= 1e-15 * high) break;
        const double h = 1e-6 * std::max(r, 1e-3);
        const double slope = (error + d - distortion::distorted_radius(camera, r - h)) / h;
        const double newton = r - error / slope;
        r = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return r;
}

/// m with distort(m) = d: Newton's method from the radial solution, steps halved while they leave the domain.
bool undistort(const Camera& camera, const Vec2& d, Vec2& m) noexcept {
    const double r_d = d.norm();
    if (!(r_d > 0.0)) {
        m.setZero();
        return std::isfinite(r_d) && camera.radius_limit > 0.0;
    }
    double r = ideal_radius(camera, r_d);
    if (r < 0.0) return false;
    if (camera.model == CameraModel::equidistant) r = std::tan(r);
    Vec2 x = (r / r_d) * d, value, trial;
    Mat22 J;
    if (!distortion::distort(camera, x, value, J)) return false;
    for (int i = 0; i < 20 && (value - d).norm() > 1e-14 * std::max(1.0, r_d); ++i) {
        Vec2 step = J.inverse() * (d - value);
        bool inside = false;
        for (int halvings = 0; halvings < 10 && !inside; ++halvings, step *= 0.5) {
            trial = x + step;
            inside = distortion::distort(camera, trial, value, J);
        }
        if (!inside) return false;
        x = trial;
    }
    m = x;
    return (value - d).norm() <= 1e-11 * std::max(1.0, r_d);
}

[[noreturn]] void refuse(const std::string& field, const std::string& expected, const std::string& got) {
    throw std::invalid_argument("camera " + field + ": expected " + expected + ", got " + got);
}

}  // namespace

bool Camera::project_distorted(const Vec3& p_camera, Vec2& z, Mat23* J) const noexcept {
    if (!(p_camera.z() >= min_depth)) return false;
    const double inverse_depth = 1.0 / p_camera.z();
    const Vec2 m = p_camera.head<2>() * inverse_depth;
    Vec2 d;
    Mat22 J_d;
    if (!distortion::distort(*this, m, d, J_d)) return false;
    const Vec2 pixel(fx * d.x() + cx, fy * d.y() + cy);
    if (!std::isfinite(pixel.sum())) return false;
    z = pixel;
    if (J != nullptr) {
        const Mat22 A = Vec2(fx * inverse_depth, fy * inverse_depth).asDiagonal() * J_d;
        *J << A, -(A * m);
    }
    return true;
}

bool Camera::unproject(const Vec2& z, Vec3& ray_camera) const noexcept {
    const Vec2 d((z.x() - cx) / fx, (z.y() - cy) / fy);
    if (!std::isfinite(d.sum())) return false;
    Vec2 m = d;
    if (model != CameraModel::pinhole && !undistort(*this, d, m)) return false;
    ray_camera = Vec3(m.x(), m.y(), 1.0).stableNormalized();
    return true;
}

int distortion_size(CameraModel model) noexcept {
    switch (model) {
        case CameraModel::plumb_bob:
            return 5;
        case CameraModel::rational:
            return 8;
        case CameraModel::equidistant:
            return 4;
        case CameraModel::pinhole:
            break;
    }
    return 0;
}

Camera make_camera(CameraModel model, int width, int height, const Mat33& K, std::span<const double> distortion) {
    const std::size_t expected = static_cast<std::size_t>(distortion_size(model));
    if (distortion.size() != expected) {
        refuse("distortion", std::to_string(expected) + " coefficients", std::to_string(distortion.size()));
    }
    if (K(0, 1) != 0.0 || K(1, 0) != 0.0 || K(2, 0) != 0.0 || K(2, 1) != 0.0 || K(2, 2) != 1.0) {
        refuse("K", "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]", "skew or another last row");
    }
    Camera camera{
        .model = model, .width = width, .height = height, .fx = K(0, 0), .fy = K(1, 1), .cx = K(0, 2), .cy = K(1, 2)};
    std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
    camera.radius_limit = distortion::radius_limit(camera);
    validate(camera);
    return camera;
}

void validate(const Camera& camera) {
    if (camera.width <= 0 || camera.height <= 0) {
        refuse("size", "positive width and height",
               std::to_string(camera.width) + " x " + std::to_string(camera.height));
    }
    if (!(camera.fx > 0.0 && camera.fy > 0.0) || !std::isfinite(camera.fx + camera.fy)) {
        refuse("K", "positive focal lengths", std::to_string(camera.fx) + " and " + std::to_string(camera.fy));
    }
    if (!std::isfinite(camera.cx + camera.cy)) {
        refuse("K", "a finite principal point", std::to_string(camera.cx) + " and " + std::to_string(camera.cy));
    }
    for (const double k : camera.distortion) {
        if (!std::isfinite(k)) refuse("distortion", "finite coefficients", std::to_string(k));
    }
    if (!(camera.min_depth > 0.0) || !std::isfinite(camera.min_depth)) {
        refuse("min_depth", "a positive number", std::to_string(camera.min_depth));
    }
    if (camera.model != CameraModel::pinhole && !(camera.radius_limit > 0.0)) {
        refuse("radius_limit", "a positive number as make_camera sets it", std::to_string(camera.radius_limit));
    }
}

}  // namespace fairlead
