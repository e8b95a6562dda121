// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Monte Carlo: arrays of many flights in, arrays of answers out.
#include "fairlead/study.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "bind.hpp"
#include "convert.hpp"

namespace nb = nanobind;

namespace fairlead::bindings {
namespace {

using Points = Array<nb::shape<-1, -1, 3>>;
using Squares = Array<nb::shape<-1, -1, -1>>;
using Poses = Array<nb::shape<-1, -1, 4, 4>>;
using Pixels = Array<nb::shape<-1, -1, -1, 2>>;
using Covariances = Array<nb::shape<-1, -1, -1, 2, 2>>;

using Matrix44 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

struct Flights {
    Camera camera;
    std::vector<study::Flight> flights;
};

std::vector<Vec3> points(const Points& all, std::size_t run) {
    std::vector<Vec3> X(all.shape(1));
    for (std::size_t j = 0; j < X.size(); ++j) X[j] = Eigen::Map<const Vec3>(all.data() + 3 * (run * X.size() + j));
    return X;
}

/// A pose that holds anything but finite numbers is none.
SE3 pose_or_none(const double* numbers, const std::string& name) {
    const Eigen::Map<const Matrix44> T(numbers);
    if (T.allFinite()) return to_pose(numbers, name);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {Mat33::Constant(nan), Vec3::Constant(nan)};
}

std::vector<SE3> poses(const Poses& all, std::size_t run, const std::string& name) {
    std::vector<SE3> T(all.shape(1));
    for (std::size_t k = 0; k < T.size(); ++k)
        T[k] = pose_or_none(all.data() + 16 * (run * T.size() + k), name + " of view " + std::to_string(k));
    return T;
}

/// Landmarks in order; a pixel that is not finite is no observation.
std::vector<std::vector<Observation>> views(const Pixels& pixels, const Covariances& covariances, std::size_t run) {
    const std::size_t n = pixels.shape(2);
    std::vector<std::vector<Observation>> views(pixels.shape(1));
    for (std::size_t k = 0; k < views.size(); ++k) {
        views[k].reserve(n);
        for (std::size_t j = 0; j < n; ++j) {
            const std::size_t place = (run * views.size() + k) * n + j;
            const Vec2 z = Eigen::Map<const Vec2>(pixels.data() + 2 * place);
            if (!z.allFinite()) continue;
            const Mat22 S =
                Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(covariances.data() + 4 * place);
            views[k].push_back({.landmark = static_cast<int>(j), .z = z, .covariance = S});
        }
    }
    return views;
}

Flights make_flights(const Camera& camera, const Points& X_true, const Points& X0, const Squares& P0,
                     const Indices64& stamps_ns, const Poses& T_true, const Poses& T_start, const Pixels& pixels,
                     const Covariances& covariances) {
    const std::size_t runs = X0.shape(0), n = X0.shape(1), k = T_true.shape(1);
    const bool alike = X_true.shape(0) == runs && X_true.shape(1) == n && P0.shape(0) == runs && P0.shape(1) == 3 * n &&
                       P0.shape(2) == 3 * n && stamps_ns.size() == k && T_true.shape(0) == runs &&
                       T_start.shape(0) == runs && T_start.shape(1) == k && pixels.shape(0) == runs &&
                       pixels.shape(1) == k && pixels.shape(2) == n && covariances.shape(0) == runs &&
                       covariances.shape(1) == k && covariances.shape(2) == n;
    if (!alike)
        throw std::invalid_argument("flights: expected arrays of " + std::to_string(runs) + " runs, " +
                                    std::to_string(k) + " views and " + std::to_string(n) + " landmarks");
    Flights all{.camera = camera, .flights = std::vector<study::Flight>(runs)};
    for (std::size_t run = 0; run < runs; ++run) {
        study::Flight& flight = all.flights[run];
        flight.X_true = points(X_true, run);
        flight.X0 = points(X0, run);
        const auto rows = static_cast<Eigen::Index>(3 * n);
        flight.P0 = Eigen::Map<const RowMajor>(P0.data() + 9 * n * n * run, rows, rows);
        flight.stamps_ns.assign(stamps_ns.data(), stamps_ns.data() + k);
        flight.T_true = poses(T_true, run, "T_true");
        flight.T_start = poses(T_start, run, "T_start");
        flight.views = views(pixels, covariances, run);
    }
    return all;
}

study::Method to_method(const std::string& name) {
    using enum study::Method;
    static const std::map<std::string, study::Method> methods{
        {"start", start}, {"single_view", single_view}, {"free_window", free_window},
        {"map", map},     {"online", online},           {"true_model", true_model},
        {"bound", bound}};
    const auto found = methods.find(name);
    if (found == methods.end()) throw std::invalid_argument("method: unknown name " + name);
    return found->second;
}

/// One row per run: poses (16 a view), their covariances (36), landmarks (3), their covariance (none or all), and
/// iterations with seconds. Python gives the rows their shapes.
nb::tuple as_rows(const std::vector<study::Answer>& answers) {
    const auto runs = static_cast<Eigen::Index>(answers.size());
    const study::Answer first = answers.empty() ? study::Answer{} : answers.front();
    const auto views = static_cast<Eigen::Index>(first.T_camera_target.size());
    MatX T(runs, 16 * views), S(runs, 36 * views), counts(runs, 2);
    MatX X(runs, 3 * static_cast<Eigen::Index>(first.X.size()));
    MatX P = MatX::Constant(runs, first.X_covariance.size(), std::numeric_limits<double>::quiet_NaN());
    for (Eigen::Index run = 0; run < runs; ++run) {
        const study::Answer& answer = answers[static_cast<std::size_t>(run)];
        for (Eigen::Index k = 0; k < views; ++k) {
            const auto view = static_cast<std::size_t>(k);
            const Eigen::Matrix4d columns = matrix(answer.T_camera_target[view]).transpose();
            T.row(run).segment(16 * k, 16) = columns.reshaped().transpose();
            S.row(run).segment(36 * k, 36) = answer.covariances[view].reshaped().transpose();
        }
        for (std::size_t j = 0; j < answer.X.size(); ++j)
            X.row(run).segment(3 * static_cast<Eigen::Index>(j), 3) = answer.X[j].transpose();
        if (answer.X_covariance.size() == P.cols()) {
            const MatX transposed = answer.X_covariance.transpose();
            P.row(run) = transposed.reshaped().transpose();
        }
        counts.row(run) << answer.iterations, answer.seconds;
    }
    return nb::make_tuple(to_array(T), to_array(S), to_array(X), to_array(P), to_array(counts));
}

nb::tuple solve(const Flights& all, const std::string& method, const study::FreeWindowOptions& free_window,
                const TrackerOptions& tracker, int threads) {
    const study::Method which = to_method(method);
    const study::Options options{.free_window = free_window, .tracker = tracker};
    std::vector<study::Answer> answers;
    {
        const nb::gil_scoped_release release;
        answers = study::solve_all(which, all.camera, all.flights, options, threads);
    }
    return as_rows(answers);
}

}  // namespace

void bind_study(nb::module_& m) {
    nb::class_<study::FreeWindowOptions>(m, "FreeWindowOptions")
        .def(nb::init<>())
        .def_rw("max_iterations", &study::FreeWindowOptions::max_iterations)
        .def_rw("initial_damping", &study::FreeWindowOptions::initial_damping)
        .def_rw("tolerance", &study::FreeWindowOptions::tolerance)
        .def_rw("refine_start", &study::FreeWindowOptions::refine_start)
        .def_rw("pnp_after", &study::FreeWindowOptions::pnp_after);
    nb::class_<Flights>(m, "Flights")
        .def(
            "__init__",
            [](Flights* self, const Camera& camera, const Points& X_true, const Points& X0, const Squares& P0,
               const Indices64& stamps_ns, const Poses& T_true, const Poses& T_start, const Pixels& pixels,
               const Covariances& covariances) {
                new (self)
                    Flights(make_flights(camera, X_true, X0, P0, stamps_ns, T_true, T_start, pixels, covariances));
            },
            nb::arg("camera"), nb::arg("X_true"), nb::arg("X0"), nb::arg("P0"), nb::arg("stamps_ns"), nb::arg("T_true"),
            nb::arg("T_start"), nb::arg("pixels"), nb::arg("covariances"))
        .def("solve", &solve, nb::arg("method"), nb::arg("free_window"), nb::arg("tracker"), nb::arg("threads"));
}

}  // namespace fairlead::bindings
