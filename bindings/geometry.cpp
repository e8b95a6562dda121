// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Camera, and points through it.
#include <nanobind/stl/string.h>

#include "bind.hpp"
#include "convert.hpp"

namespace fairlead::bindings {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

CameraModel model_of(const std::string& name) {
    if (name == "pinhole") return CameraModel::pinhole;
    if (name == "plumb_bob") return CameraModel::plumb_bob;
    if (name == "rational_polynomial") return CameraModel::rational;
    if (name == "equidistant") return CameraModel::equidistant;
    throw std::invalid_argument("camera model: expected pinhole, plumb_bob, rational_polynomial or equidistant, got '" +
                                name + "'");
}

Camera to_camera(const std::string& model, int width, int height, const Square& K, const Vector& distortion) {
    if (K.shape(0) != 3 || K.shape(1) != 3) {
        throw std::invalid_argument("camera K: expected shape (3, 3), got (" + std::to_string(K.shape(0)) + ", " +
                                    std::to_string(K.shape(1)) + ")");
    }
    return make_camera(model_of(model), width, height, Mat33(to_matrix(K)),
                       std::span(distortion.data(), distortion.size()));
}

nb::ndarray<nb::numpy, double> project(const Camera& camera, const Rows3& points_camera) {
    const std::vector<Vec3> p = to_points(points_camera);
    RowMajor pixels = RowMajor::Constant(static_cast<Eigen::Index>(p.size()), 2, kNaN);
    {
        const nb::gil_scoped_release release;
        Vec2 z;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (camera.project(p[i], z)) pixels.row(static_cast<Eigen::Index>(i)) = z.transpose();
        }
    }
    return to_array(MatX(pixels));
}

nb::ndarray<nb::numpy, double> unproject(const Camera& camera, const Rows2& pixels) {
    const std::size_t n = pixels.shape(0);
    const double* const first = pixels.data();
    std::vector<Vec3> rays(n, Vec3::Constant(kNaN));
    {
        const nb::gil_scoped_release release;
        for (std::size_t i = 0; i < n; ++i) {
            Vec3 ray;
            if (camera.unproject(Eigen::Map<const Vec2>(first + 2 * i), ray)) rays[i] = ray;
        }
    }
    return to_array(rays);
}

}  // namespace

void bind_geometry(nb::module_& m) {
    nb::class_<Camera>(m, "Camera")
        .def(
            "__init__",
            [](Camera* self, const std::string& model, int width, int height, const Square& K,
               const Vector& distortion) { new (self) Camera(to_camera(model, width, height, K, distortion)); },
            nb::arg("model"), nb::arg("width"), nb::arg("height"), nb::arg("K"), nb::arg("distortion"));
    m.def("project", &project, nb::arg("camera"), nb::arg("points_camera"),
          "Pixels (n, 2); NaN rows where a point has none.");
    m.def("unproject", &unproject, nb::arg("camera"), nb::arg("pixels"),
          "Unit rays (n, 3); NaN rows where a pixel has none.");
}

}  // namespace fairlead::bindings
