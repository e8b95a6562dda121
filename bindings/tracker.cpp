// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// The estimator: Tracker, refine, and the bare window solve that the baselines and the benchmarks use.
#include "fairlead/tracker.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "bind.hpp"
#include "convert.hpp"
#include "fairlead/refine.hpp"
#include "fairlead/window/levenberg_marquardt.hpp"

namespace nb = nanobind;

namespace fairlead::bindings {
namespace {

nb::tuple as_tuple(const Estimate& e) {
    return nb::make_tuple(e.stamp_ns, to_string(e.status), to_string(e.reason), to_array(matrix(e.T_camera_target)),
                          to_array(e.covariance), e.inliers, e.dropped, e.reprojection_rms_px, e.information_gained,
                          e.resets, std::vector<int>(e.inlier_landmarks.begin(), e.inlier_landmarks.end()));
}

nb::tuple update(Tracker& tracker, std::int64_t stamp_ns, const Indices& landmarks, const Rows2& pixels,
                 const Rows22& covariances) {
    const std::vector<Observation> observations = to_observations(landmarks, pixels, covariances);
    Estimate estimate;
    {
        const nb::gil_scoped_release release;
        estimate = tracker.update(stamp_ns, observations);
    }
    return as_tuple(estimate);
}

nb::tuple refine_views(const Camera& camera, const Rows3& X0, const Square& P0, const Indices64& stamps_ns,
                       const Indices& sizes, const Indices& landmarks, const Rows2& pixels, const Rows22& covariances,
                       const TrackerOptions& options, const BatchReadings& readings) {
    const std::vector<Observation> observations = to_observations(landmarks, pixels, covariances);
    if (sizes.size() != stamps_ns.size()) throw std::invalid_argument("sizes: expected one per stamp");
    std::vector<BatchView> views;
    std::size_t first = 0;
    for (std::size_t k = 0; k < stamps_ns.size(); ++k) {
        const std::int32_t size = sizes.data()[k];
        if (size < 0 || first + static_cast<std::size_t>(size) > observations.size())
            throw std::invalid_argument("sizes: got views of more observations than were given");
        views.push_back({stamps_ns.data()[k], std::span(observations).subspan(first, static_cast<std::size_t>(size))});
        first += static_cast<std::size_t>(size);
    }
    Refinement refinement;
    const std::vector<Vec3> X = to_points(X0);
    const MatX P = to_matrix(P0);
    {
        const nb::gil_scoped_release release;
        refinement = refine(camera, X, P, views, options, readings);
    }
    nb::list estimates;
    for (const Estimate& e : refinement.estimates) estimates.append(as_tuple(e));
    return nb::make_tuple(estimates, to_array(refinement.X), to_array(refinement.covariance), refinement.noise_factor,
                          refinement.prior_factor, refinement.prior_factor_believed, refinement.cost,
                          refinement.iterations, refinement.converged, refinement.ranges_believed,
                          refinement.ranges_refused, refinement.range_bias.bias_m, refinement.range_bias.sigma_m);
}

window::Problem make_problem(const Camera& camera, const Rows3& X, const Rows44& T, const Indices& view_index,
                             const Indices& landmarks, const Rows2& pixels, const Rows22& covariances,
                             double loss_threshold) {
    window::Problem problem;
    problem.camera = camera;
    problem.X = to_points(X);
    problem.loss.threshold = loss_threshold;
    for (std::size_t k = 0; k < T.shape(0); ++k) {
        window::ViewBlock view(problem.landmarks());
        view.state.T_camera_target = to_pose(T, k);
        problem.views.push_back(std::move(view));
    }
    const std::vector<Observation> observations = to_observations(landmarks, pixels, covariances);
    if (view_index.size() != observations.size())
        throw std::invalid_argument("view_index: expected one per observation");
    for (std::size_t i = 0; i < observations.size(); ++i) {
        const std::int32_t k = view_index.data()[i];
        const Observation& o = observations[i];
        if (k < 0 || static_cast<std::size_t>(k) >= problem.views.size() || o.landmark < 0 ||
            o.landmark >= problem.landmarks())
            throw std::invalid_argument("observation " + std::to_string(i) + ": view or landmark index out of range");
        problem.views[static_cast<std::size_t>(k)].measurements.push_back({o.landmark, o.z, o.covariance.inverse()});
    }
    return problem;
}

Mat33 to_rotation(const Square& R) {
    const MatX matrix = to_matrix(R);
    if (matrix.rows() != 3) throw std::invalid_argument("R_world_camera: expected 3 x 3");
    return matrix;
}

nb::tuple solve_window(const Camera& camera, const Rows3& X, const Rows44& T, const Indices& view_index,
                       const Indices& landmarks, const Rows2& pixels, const Rows22& covariances,
                       const nb::object& prior_mean, const nb::object& prior_information, double loss_threshold,
                       int max_iterations, double initial_damping, double tolerance) {
    window::Problem problem = make_problem(camera, X, T, view_index, landmarks, pixels, covariances, loss_threshold);
    if (!prior_information.is_none()) {
        const std::vector<Vec3> mean = to_points(nb::cast<Rows3>(prior_mean));
        const MatX information = to_matrix(nb::cast<Square>(prior_information));
        const Eigen::Index rows = 3 * static_cast<Eigen::Index>(problem.X.size());
        if (information.rows() != rows || mean.size() != problem.X.size())
            throw std::invalid_argument(
                "prior: expected the mean (n, 3) and the information (3n, 3n) of all landmarks");
        problem.prior.emplace(Eigen::Map<const VecX>(mean.front().data(), rows), information, VecX::Zero(rows));
    }
    window::LmSummary summary;
    {
        const nb::gil_scoped_release release;
        window::Workspace workspace(problem.landmarks());
        summary = window::levenberg_marquardt(
            problem, {.max_iterations = max_iterations, .initial_damping = initial_damping, .tolerance = tolerance},
            workspace);
    }
    nb::list poses;
    for (const window::ViewBlock& view : problem.views) poses.append(to_array(matrix(view.state.T_camera_target)));
    return nb::make_tuple(to_array(problem.X), poses, summary.cost, summary.iterations, summary.converged, summary.ok);
}

void bind_options(nb::module_& m) {
    nb::class_<TrackerOptions>(m, "TrackerOptions")
        .def(nb::init<>())
        .def_rw("max_views", &TrackerOptions::max_views)
        .def_rw("loss_threshold", &TrackerOptions::loss_threshold)
        .def_rw("gate", &TrackerOptions::gate)
        .def_rw("min_inlier_ratio", &TrackerOptions::min_inlier_ratio)
        .def_rw("coast_limit_s", &TrackerOptions::coast_limit_s)
        .def_rw("max_step_rad", &TrackerOptions::max_step_rad)
        .def_rw("confirmations", &TrackerOptions::confirmations)
        .def_rw("ambiguity_log_odds", &TrackerOptions::ambiguity_log_odds)
        .def_prop_rw(
            "motion", [](const TrackerOptions& o) { return motion::to_string(o.motion); },
            [](TrackerOptions& o, const std::string& name) { o.motion = motion::kind_named(name); })
        .def_rw("jerk_density_m_s25", &TrackerOptions::jerk_density_m_s25)
        .def_rw("correlation_time_s", &TrackerOptions::correlation_time_s)
        .def_rw("correlation_angle_rad", &TrackerOptions::correlation_angle_rad)
        .def_rw("correlation_log_range", &TrackerOptions::correlation_log_range)
        .def_rw("design_effect", &TrackerOptions::design_effect)
        .def_rw("range_to_origin", &TrackerOptions::range_to_origin)
        .def_rw("range_bias_sigma_m", &TrackerOptions::range_bias_sigma_m)
        .def_rw("seed", &TrackerOptions::seed);
}

void bind_readings(nb::module_& m) {
    nb::class_<BatchReadings>(m, "BatchReadings")
        .def(nb::init<>())
        .def("add_length", [](BatchReadings& readings, int a, int b, double length_m,
                              double sigma_m) { readings.lengths.push_back({a, b, length_m, sigma_m}); })
        .def("add_range", [](BatchReadings& readings, std::int64_t stamp_ns, double range_m, double sigma_m,
                             int landmark) { readings.ranges.push_back({stamp_ns, {landmark, range_m, sigma_m}}); })
        .def("add_attitude", [](BatchReadings& readings, std::int64_t stamp_ns, const Square& R, double sigma_rad) {
            readings.attitudes.push_back({stamp_ns, {to_rotation(R), sigma_rad}});
        });
}

}  // namespace

void bind_tracker(nb::module_& m) {
    bind_options(m);
    bind_readings(m);
    nb::class_<Tracker>(m, "Tracker")
        .def("__init__",
             [](Tracker* self, const Camera& camera, const Rows3& X0, const Square& P0, const TrackerOptions& options) {
                 new (self) Tracker(camera, to_points(X0), to_matrix(P0), options);
             })
        .def("add_length", &Tracker::add_length)
        .def("add_range", &Tracker::add_range)
        .def("add_attitude", [](Tracker& t, std::int64_t stamp_ns, const Square& R,
                                double sigma_rad) { t.add_attitude(stamp_ns, to_rotation(R), sigma_rad); })
        .def("add_pose", [](Tracker& t, std::int64_t stamp_ns, const Rows44& T,
                            const Square& covariance) { t.add_pose(stamp_ns, to_pose(T, 0), to_matrix(covariance)); })
        .def("update", &update)
        .def("predict", [](const Tracker& t, std::int64_t stamp_ns) { return as_tuple(t.predict(stamp_ns)); })
        .def("landmarks",
             [](const Tracker& t) { return to_array(std::vector<Vec3>(t.landmarks().begin(), t.landmarks().end())); })
        .def("landmark_covariance", [](const Tracker& t) { return to_array(t.landmark_covariance()); })
        .def_prop_ro("noise_factor", &Tracker::noise_factor)
        .def_prop_ro("prior_factor", &Tracker::prior_factor)
        .def("gauge_sigma",
             [](const Tracker& t, bool told) {
                 const window::GaugeSigma sigma = told ? t.gauge_sigma_told() : t.gauge_sigma();
                 VecX all(7);
                 all << sigma.translation_m, sigma.rotation_rad, sigma.scale;
                 return to_array(all);
             })
        .def("predicted_gain", [](const Tracker& t, const Rows44& T,
                                  double sigma_px) { return t.predicted_gain(to_pose(T, 0), sigma_px); })
        .def_prop_ro("determined_directions", &Tracker::determined_directions)
        .def_prop_ro("ranges_believed", &Tracker::ranges_believed)
        .def_prop_ro("ranges_refused", &Tracker::ranges_refused)
        .def_prop_ro("range_bias",
                     [](const Tracker& t) { return nb::make_tuple(t.range_bias().bias_m, t.range_bias().sigma_m); })
        .def_prop_ro("views_in_window", &Tracker::views_in_window);
    m.attr("ORIGIN") = Tracker::kOrigin;
    m.def("refine", &refine_views);
    m.def("solve_window", &solve_window, nb::arg("camera"), nb::arg("X"), nb::arg("T"), nb::arg("view_index"),
          nb::arg("landmarks"), nb::arg("pixels"), nb::arg("covariances"), nb::arg("prior_mean") = nb::none(),
          nb::arg("prior_information") = nb::none(),
          nb::arg("loss_threshold") = std::numeric_limits<double>::infinity(), nb::arg("max_iterations") = 50,
          nb::arg("initial_damping") = 1e-4, nb::arg("tolerance") = 1e-9);
}

}  // namespace fairlead::bindings
