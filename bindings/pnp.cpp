// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// One pose from one view. What is not ok comes back as NaN.
#include <array>

#include "bind.hpp"
#include "convert.hpp"
#include "fairlead/pnp/p3p.hpp"
#include "fairlead/pnp/planar.hpp"
#include "fairlead/pnp/ransac.hpp"

namespace fairlead::bindings {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Everything a pose from one view needs.
struct Task {
    std::vector<Vec3> X;
    std::vector<Observation> observations;
    Loss loss;
};

Task to_task(const Rows3& X, const Indices& landmarks, const Rows2& pixels, const Rows22& covariances,
             double loss_threshold) {
    Task task{
        .X = to_points(X), .observations = to_observations(landmarks, pixels, covariances), .loss = {loss_threshold}};
    validate(task.loss);
    for (std::size_t i = 0; i < task.observations.size(); ++i) {
        const int landmark = task.observations[i].landmark;
        if (landmark >= 0 && static_cast<std::size_t>(landmark) < task.X.size()) continue;
        throw std::invalid_argument("landmarks: expected indices from 0 to " + std::to_string(task.X.size()) +
                                    " - 1, got " + std::to_string(landmark) + " at " + std::to_string(i));
    }
    return task;
}

nb::tuple as_tuple(const pnp::RefineResult& r) {
    const Eigen::Matrix4d T = r.ok ? matrix(r.T_camera_target) : Eigen::Matrix4d::Constant(kNaN);
    const Mat66 information = r.ok ? r.information : Mat66::Constant(kNaN);
    return nb::make_tuple(to_array(T), to_array(information), r.cost, r.inliers, r.iterations, r.ok);
}

nb::ndarray<nb::numpy, double> p3p(const Array<nb::shape<3, 3>>& rays_camera, const Array<nb::shape<3, 3>>& X_target) {
    std::array<Vec3, 3> rays, X;
    for (std::size_t i = 0; i < 3; ++i) {
        rays[i] = Eigen::Map<const Vec3>(rays_camera.data() + 3 * i);
        X[i] = Eigen::Map<const Vec3>(X_target.data() + 3 * i);
    }
    std::array<SE3, 4> T;
    std::size_t count = 0;
    {
        const nb::gil_scoped_release release;
        count = static_cast<std::size_t>(pnp::p3p(rays, X, T));
    }
    auto* const numbers = new double[16 * count];
    for (std::size_t k = 0; k < count; ++k)
        Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers + 16 * k) = matrix(T[k]);
    const nb::capsule owner(numbers, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    return {numbers, {count, 4, 4}, owner};
}

nb::tuple pnp_refine(const Camera& camera, const Pose& T_start, const Rows3& X, const Indices& landmarks,
                     const Rows2& pixels, const Rows22& covariances, double loss_threshold, int max_iterations) {
    const Task task = to_task(X, landmarks, pixels, covariances, loss_threshold);
    const SE3 T = to_pose(T_start.data(), "T_start");
    pnp::RefineResult result;
    {
        const nb::gil_scoped_release release;
        result = pnp::refine(T, task.X, task.observations, camera, task.loss, max_iterations);
    }
    return as_tuple(result);
}

nb::tuple ransac(const Camera& camera, const Rows3& X, const Indices& landmarks, const Rows2& pixels,
                 const Rows22& covariances, double loss_threshold, int max_iterations, double confidence,
                 std::uint64_t seed) {
    const Task task = to_task(X, landmarks, pixels, covariances, loss_threshold);
    if (!(confidence > 0.0 && confidence < 1.0))
        throw std::invalid_argument("confidence: expected a number between 0 and 1, got " + std::to_string(confidence));
    pnp::RansacResult result;
    {
        const nb::gil_scoped_release release;
        result = pnp::ransac(task.X, task.observations, camera, task.loss,
                             {.max_iterations = max_iterations, .confidence = confidence, .seed = seed});
    }
    result.pose.ok = result.ok;
    return nb::make_tuple(as_tuple(result.pose), result.iterations, result.ok);
}

nb::tuple pose_pair(const Camera& camera, const Pose& T_start, const Rows3& X, const Indices& landmarks,
                    const Rows2& pixels, const Rows22& covariances, double loss_threshold) {
    const Task task = to_task(X, landmarks, pixels, covariances, loss_threshold);
    const SE3 T = to_pose(T_start.data(), "T_start");
    pnp::PosePair pair;
    {
        const nb::gil_scoped_release release;
        pair = pnp::pose_pair(T, task.X, task.observations, camera, task.loss);
    }
    return nb::make_tuple(as_tuple(pair.best), as_tuple(pair.other), pair.distinct);
}

}  // namespace

void bind_pnp(nb::module_& m) {
    constexpr double kThreshold = Loss{}.threshold;
    constexpr pnp::RansacOptions kRansac;
    m.def("p3p", &p3p, nb::arg("rays_camera"), nb::arg("X_target"), "Poses (k, 4, 4), k <= 4.");
    m.def("pnp_refine", &pnp_refine, nb::arg("camera"), nb::arg("T_start"), nb::arg("X_target"), nb::arg("landmarks"),
          nb::arg("pixels"), nb::arg("covariances"), nb::arg("loss_threshold") = kThreshold,
          nb::arg("max_iterations") = 20, "(T_camera_target, information, cost, inliers, iterations, ok).");
    m.def("ransac", &ransac, nb::arg("camera"), nb::arg("X_target"), nb::arg("landmarks"), nb::arg("pixels"),
          nb::arg("covariances"), nb::arg("loss_threshold") = kThreshold,
          nb::arg("max_iterations") = kRansac.max_iterations, nb::arg("confidence") = kRansac.confidence,
          nb::arg("seed") = kRansac.seed, "(pose as of pnp_refine, iterations, ok).");
    m.def("pose_pair", &pose_pair, nb::arg("camera"), nb::arg("T_start"), nb::arg("X_target"), nb::arg("landmarks"),
          nb::arg("pixels"), nb::arg("covariances"), nb::arg("loss_threshold") = kThreshold,
          "(best, other, distinct), poses as of pnp_refine.");
}

}  // namespace fairlead::bindings
