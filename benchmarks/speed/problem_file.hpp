// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace fairlead::speed {

/// What benchmarks/speed/problem.py writes: every view sees every landmark.
struct ProblemFile {
    double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< pinhole [px]
    double sigma_px = 1.0;
    double prior_sigma_m = 1.0;
    std::vector<Eigen::Vector3d> X0;      ///< told landmarks and start [m]
    std::vector<Eigen::Matrix3d> R;       ///< start of each view: p_camera = R X + t
    std::vector<Eigen::Vector3d> t;       ///< [m]
    std::vector<Eigen::Vector2d> pixels;  ///< view-major [px]
};

/// An answer, in the order of the problem.
struct Answer {
    std::vector<Eigen::Vector3d> X;
    std::vector<Eigen::Matrix3d> R;
    std::vector<Eigen::Vector3d> t;
    int iterations = 0;  ///< linear systems solved
};

namespace detail {

template <class Vector>
std::vector<Vector> read_vectors(std::istream& in, std::size_t count) {
    std::vector<Vector> vectors(count);
    for (Vector& v : vectors) in.read(reinterpret_cast<char*>(v.data()), static_cast<std::streamsize>(sizeof(Vector)));
    return vectors;
}

template <class Vector>
void write_vector(std::ostream& out, const Vector& v) {
    out.write(reinterpret_cast<const char*>(v.data()), static_cast<std::streamsize>(v.size() * sizeof(double)));
}

}  // namespace detail

inline ProblemFile read_problem(const std::string& path) {
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    std::ifstream in(path, std::ios::binary);
    const auto head = detail::read_vectors<Eigen::Matrix<double, 8, 1>>(in, 1).front();
    if (!in) throw std::runtime_error(path + ": not a problem of benchmarks/speed/problem.py");
    const auto n = static_cast<std::size_t>(head[0]);
    const auto k = static_cast<std::size_t>(head[1]);
    ProblemFile problem{head[2], head[3], head[4], head[5], head[6], head[7], {}, {}, {}, {}};
    problem.X0 = detail::read_vectors<Eigen::Vector3d>(in, n);
    for (std::size_t i = 0; i < k; ++i) {
        problem.R.emplace_back(detail::read_vectors<RowMajor>(in, 1).front());
        problem.t.push_back(detail::read_vectors<Eigen::Vector3d>(in, 1).front());
    }
    problem.pixels = detail::read_vectors<Eigen::Vector2d>(in, n * k);
    if (!in) throw std::runtime_error(path + ": cut short");
    return problem;
}

/// X (n, 3), then R row-major and t of each view, float64.
inline void write_answer(const std::string& path, const Answer& answer) {
    std::ofstream out(path, std::ios::binary);
    for (const Eigen::Vector3d& X : answer.X) detail::write_vector(out, X);
    for (std::size_t k = 0; k < answer.R.size(); ++k) {
        const Eigen::Matrix3d rows = answer.R[k].transpose();
        detail::write_vector(out, rows);
        detail::write_vector(out, answer.t[k]);
    }
    if (!out.flush()) throw std::runtime_error(path + ": could not be written");
}

}  // namespace fairlead::speed
