// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/geometry/camera.hpp"

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "check.hpp"

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(camera_test)

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Mat33 intrinsics(double fx, double fy, double cx, double cy) {
    Mat33 K;
    K << fx, 0, cx, 0, fy, cy, 0, 0, 1;
    return K;
}

Camera camera_with(CameraModel model, const std::vector<double>& distortion) {
    return make_camera(model, 640, 480, intrinsics(500, 510, 320, 240), distortion);
}

std::vector<Camera> cameras() {
    return {camera_with(CameraModel::pinhole, {}),
            camera_with(CameraModel::plumb_bob, {0, 0, 0, 0, 0}),
            camera_with(CameraModel::plumb_bob, {-0.28, 0.07, 1e-3, -5e-4, 0.01}),
            camera_with(CameraModel::plumb_bob, {0.2, 0.1, -2e-3, 1e-3, 0.0}),
            camera_with(CameraModel::rational, {0.4, -0.3, 1e-3, 2e-4, 0.02, 0.7, -0.2, 0.05}),
            camera_with(CameraModel::equidistant, {0, 0, 0, 0}),
            camera_with(CameraModel::equidistant, {-0.01, 0.02, -0.008, 0.001})};
}

BOOST_AUTO_TEST_CASE(pinhole_by_hand) {
    const Camera camera = camera_with(CameraModel::pinhole, {});
    Vec2 z;
    BOOST_CHECK(camera.project(Vec3(1, -2, 10), z));
    CHECK_NEAR(z, Vec2(370, 138), 1e-12);
    Vec3 ray;
    BOOST_CHECK(camera.unproject(Vec2(370, 138), ray));
    CHECK_NEAR(ray, Vec3(1, -2, 10).normalized(), 1e-15);
}

BOOST_AUTO_TEST_CASE(distortion_by_hand) {
    Vec2 z;
    // x = 0.5, y = 0, u = 0.25: radial 1 + 0.1 u + 0.2 u^2 + 0.4 u^3 = 1.04375; tangential (0.02 * 3 u, 0.01 u).
    BOOST_CHECK(camera_with(CameraModel::plumb_bob, {0.1, 0.2, 0.01, 0.02, 0.4}).project(Vec3(1, 0, 2), z));
    CHECK_NEAR(z, Vec2(320 + 500 * (0.5 * 1.04375 + 0.015), 240 + 510 * 0.0025), 1e-11);
    // (1 + 0.1 u) / (1 + 0.2 u) = 1.025 / 1.05.
    BOOST_CHECK(camera_with(CameraModel::rational, {0.1, 0, 0, 0, 0, 0.2, 0, 0}).project(Vec3(0, 1, 2), z));
    CHECK_NEAR(z, Vec2(320, 240 + 510 * 0.5 * 1.025 / 1.05), 1e-11);
    // theta = pi / 4; theta_d = theta (1 + 0.1 theta^2).
    const double theta = std::atan(1.0);
    BOOST_CHECK(camera_with(CameraModel::equidistant, {0.1, 0, 0, 0}).project(Vec3(3, 0, 3), z));
    CHECK_NEAR(z, Vec2(320 + 500 * theta * (1 + 0.1 * theta * theta), 240), 1e-11);
}

BOOST_AUTO_TEST_CASE(models_agree_without_distortion) {
    Random random(1);
    const Camera pinhole = camera_with(CameraModel::pinhole, {});
    const Camera plumb_bob = camera_with(CameraModel::plumb_bob, {0, 0, 0, 0, 0});
    const Camera rational = camera_with(CameraModel::rational, {0, 0, 0, 0, 0, 0, 0, 0});
    for (int i = 0; i < 100; ++i) {
        const Vec3 p(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(0.1, 9));
        Vec2 a, b, c;
        BOOST_CHECK(pinhole.project(p, a) && plumb_bob.project(p, b) && rational.project(p, c));
        CHECK_NEAR(a, b, 1e-9);
        CHECK_NEAR(a, c, 1e-9);
    }
}

BOOST_AUTO_TEST_CASE(derivatives) {
    Random random(2);
    for (const Camera& camera : cameras()) {
        for (int i = 0; i < 50; ++i) {
            const double depth = random.uniform(1.0, 20.0);
            const double field = i < 3 ? 1e-9 : 0.6;
            const Vec3 p(depth * random.uniform(-field, field), depth * random.uniform(-field, field), depth);
            Vec2 z, z_only;
            Mat23 J;
            BOOST_CHECK(camera.project(p, z, J) && camera.project(p, z_only));
            CHECK_NEAR(z, z_only, 0.0);
            const auto f = [&](const Vec3& q) {
                Vec2 value = Vec2::Constant(kNaN);
                BOOST_CHECK(camera.project(q, value));
                return value;
            };
            CHECK_JACOBIAN(f, p, J);
        }
        const Vec3 axis(0, 0, 3);
        Vec2 z;
        Mat23 J;
        BOOST_CHECK(camera.project(axis, z, J) && J.allFinite());
        CHECK_NEAR(z, Vec2(320, 240), 0.0);
    }
}

BOOST_AUTO_TEST_CASE(unproject_inverts_project) {
    Random random(3);
    int inside = 0;
    for (const Camera& camera : cameras()) {
        for (int i = 0; i < 300; ++i) {
            const Vec2 z(random.uniform(-200, 840), random.uniform(-200, 680));
            Vec3 ray;
            if (!camera.unproject(z, ray)) continue;
            ++inside;
            Vec2 back;
            BOOST_CHECK(camera.project(7.0 * ray, back));
            CHECK_NEAR(back, z, 1e-8);
            CHECK_NEAR(ray.norm(), 1.0, 1e-15);
        }
        for (int i = 0; i < 300; ++i) {
            const Vec3 p(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), 1.0);
            Vec2 z;
            Vec3 ray;
            BOOST_CHECK(camera.project(p, z) && camera.unproject(z, ray));
            CHECK_NEAR(ray, p.normalized(), 1e-10);
        }
    }
    BOOST_TEST(inside > 1900);  // of 2100: strong barrel distortion leaves the far corners without a ray
}

BOOST_AUTO_TEST_CASE(behind_and_broken_points_are_refused) {
    for (const Camera& camera : cameras()) {
        for (const Vec3& p : {Vec3(0, 0, -1), Vec3(0, 0, 0), Vec3(1, 1, 1e-7), Vec3(kNaN, 0, 1), Vec3(0, kNaN, 1),
                              Vec3(0, 0, kNaN), Vec3(kInf, 0, 1), Vec3(0, -kInf, 1), Vec3(1e308, 1e308, 1e-6)}) {
            Vec2 z(1, 2);
            Mat23 J = Mat23::Constant(3);
            BOOST_CHECK(!camera.project(p, z) && z == Vec2(1, 2));
            BOOST_CHECK(!camera.project(p, z, J) && z == Vec2(1, 2) && J == Mat23::Constant(3));
        }
        for (const Vec2& z : {Vec2(kNaN, 0), Vec2(0, kInf), Vec2(kNaN, kInf)}) {
            Vec3 ray(1, 2, 3);
            BOOST_CHECK(!camera.unproject(z, ray) && ray == Vec3(1, 2, 3));
        }
    }
}

BOOST_AUTO_TEST_CASE(folds_are_refused) {
    // r (1 - 0.3 r^2) turns at r = sqrt(1 / 0.9); beyond it points come back into the image.
    const Camera barrel = camera_with(CameraModel::plumb_bob, {-0.3, 0, 0, 0, 0});
    CHECK_NEAR(barrel.radius_limit, std::sqrt(1.0 / 0.9), 1e-12);
    Vec2 z;
    Vec3 ray;
    BOOST_CHECK(barrel.project(Vec3(1.05, 0, 1), z));
    BOOST_CHECK(!barrel.project(Vec3(1.06, 0, 1), z));
    BOOST_CHECK(!barrel.project(Vec3(1.8, 0, 1), z));  // would come to pixel 345
    BOOST_CHECK(!barrel.unproject(Vec2(320 + 500 * 0.71, 240), ray));
    // Folds at 1 and unfolds again further out: d/dr = 1 - 2.2 u + 1.2 u^2 = (1 - u)(1 - 1.2 u).
    const Camera twice = camera_with(CameraModel::plumb_bob, {-2.2 / 3.0, 1.2 / 5.0, 0, 0, 0});
    CHECK_NEAR(twice.radius_limit, std::sqrt(1.0 / 1.2), 1e-12);
    BOOST_CHECK(!twice.project(Vec3(3, 0, 1), z));
    // Pole of the rational model at u = 4.
    const Camera pole = camera_with(CameraModel::rational, {0, 0, 0, 0, 0, -0.25, 0, 0});
    CHECK_NEAR(pole.radius_limit, 2.0, 1e-12);
    // theta (1 - 0.5 theta^2) turns at theta = sqrt(2 / 3).
    const Camera fisheye = camera_with(CameraModel::equidistant, {-0.5, 0, 0, 0});
    CHECK_NEAR(fisheye.radius_limit, std::sqrt(2.0 / 3.0), 1e-12);
    BOOST_CHECK(fisheye.project(Vec3(1.06, 0, 1), z) && !fisheye.project(Vec3(1.07, 0, 1), z));
    BOOST_CHECK(camera_with(CameraModel::equidistant, {0, 0, 0, 0}).project(Vec3(1000, 0, 1), z));
}

BOOST_AUTO_TEST_CASE(a_camera_not_made_by_make_camera_projects_nothing) {
    Camera camera = camera_with(CameraModel::plumb_bob, {-0.1, 0, 0, 0, 0});
    camera.radius_limit = -1.0;
    Vec2 z;
    Vec3 ray;
    BOOST_CHECK(!camera.project(Vec3(0, 0, 1), z) && !camera.project(Vec3(0.1, 0, 1), z));
    BOOST_CHECK(!camera.unproject(Vec2(320, 240), ray) && !camera.unproject(Vec2(330, 240), ray));
}

template <typename F>
std::string message_of(const F& f) {
    try {
        f();
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

BOOST_AUTO_TEST_CASE(unusable_cameras_are_refused) {
    const Mat33 K = intrinsics(500, 510, 320, 240);
    const std::vector<double> none, two{0.1, 0.2}, nan{0.1, kNaN, 0, 0};
    const auto make = [&](CameraModel model, int width, const Mat33& matrix, const std::vector<double>& distortion) {
        return message_of([&] { (void)make_camera(model, width, 480, matrix, distortion); });
    };
    BOOST_CHECK(make(CameraModel::plumb_bob, 640, K, two) == "camera distortion: expected 5 coefficients, got 2");
    BOOST_CHECK(make(CameraModel::pinhole, 0, K, none) ==
                "camera size: expected positive width and height, got 0 x 480");
    BOOST_CHECK(make(CameraModel::equidistant, 640, K, nan).starts_with("camera distortion: expected finite"));
    BOOST_CHECK(make(CameraModel::pinhole, 640, intrinsics(-500, 510, 320, 240), none)
                    .starts_with("camera K: expected positive focal"));
    BOOST_CHECK(make(CameraModel::pinhole, 640, intrinsics(kInf, 510, 320, 240), none)
                    .starts_with("camera K: expected positive focal"));
    BOOST_CHECK(make(CameraModel::pinhole, 640, intrinsics(500, 510, kNaN, 240), none)
                    .starts_with("camera K: expected a finite"));
    Mat33 skew = K;
    skew(0, 1) = 1.0;
    BOOST_CHECK(make(CameraModel::pinhole, 640, skew, none).starts_with("camera K: expected [[fx"));
    BOOST_CHECK(make(CameraModel::pinhole, 640, K, none).empty());
    Camera camera = camera_with(CameraModel::pinhole, {});
    camera.min_depth = 0.0;
    BOOST_CHECK(message_of([&] { validate(camera); }).starts_with("camera min_depth"));
}

BOOST_AUTO_TEST_SUITE_END()
