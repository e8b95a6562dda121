// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Processor time of each update() of a flight: update FLIGHT TIMES REPEATS VIEWS. The flight is what
// benchmarks/speed/update.py writes, VIEWS the size of the window; TIMES gets float64 seconds, one row of frames per
// repeat; stdout the number of frames without a pose and the first frame that met a full window.
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>

#include "fairlead/tracker.hpp"
#include "fairlead/window/landmark_prior.hpp"
#include "problem_file.hpp"

namespace {

using namespace fairlead;

struct Flight {
    Camera camera;
    std::vector<Vec3> X0;
    double sigma_px = 1.0;
    double prior_sigma_m = 1.0;
    std::vector<std::int64_t> stamps_ns;
    std::vector<std::vector<Observation>> views;
};

Flight read_flight(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    const auto head = speed::detail::read_vectors<Eigen::Matrix<double, 8, 1>>(in, 1).front();
    if (!in) throw std::runtime_error(path + ": not a flight of benchmarks/speed/update.py");
    Flight flight;
    flight.camera = {.width = 1024, .height = 1024, .fx = head[2], .fy = head[3], .cx = head[4], .cy = head[5]};
    flight.sigma_px = head[6];
    flight.prior_sigma_m = head[7];
    flight.X0 = speed::detail::read_vectors<Vec3>(in, static_cast<std::size_t>(head[0]));
    const Mat22 covariance = flight.sigma_px * flight.sigma_px * Mat22::Identity();
    for (int frame = 0; frame < static_cast<int>(head[1]); ++frame) {
        const auto stamp = speed::detail::read_vectors<Eigen::Matrix<double, 1, 1>>(in, 1).front();
        flight.stamps_ns.push_back(static_cast<std::int64_t>(stamp[0]));
        flight.views.emplace_back();
        for (const Vec2& z : speed::detail::read_vectors<Vec2>(in, flight.X0.size())) {
            const int landmark = static_cast<int>(flight.views.back().size());
            flight.views.back().push_back({.landmark = landmark, .z = z, .covariance = covariance});
        }
    }
    if (!in) throw std::runtime_error(path + ": cut short");
    return flight;
}

double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

int fly(const Flight& flight, int max_views, std::vector<double>& seconds, std::size_t& full) {
    const std::vector<Vec3> sigma(flight.X0.size(), Vec3::Constant(flight.prior_sigma_m));
    TrackerOptions options;
    options.max_views = max_views;
    Tracker tracker(flight.camera, flight.X0, window::landmark_covariance(flight.X0, sigma, 0.0), options);
    int without_pose = 0;
    full = flight.views.size();
    for (std::size_t frame = 0; frame < flight.views.size(); ++frame) {
        if (tracker.views_in_window() == max_views) full = std::min(full, frame);
        const double begin = thread_seconds();
        const Estimate estimate = tracker.update(flight.stamps_ns[frame], flight.views[frame]);
        seconds.push_back(thread_seconds() - begin);
        if (estimate.status != Status::tracking) ++without_pose;
    }
    return without_pose;
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 5) throw std::runtime_error("usage: update FLIGHT TIMES REPEATS VIEWS");
    const Flight flight = read_flight(argv[1]);
    std::vector<double> seconds;
    int without_pose = 0;
    std::size_t full = 0;
    for (int repeat = 0; repeat < std::atoi(argv[3]); ++repeat) without_pose = fly(flight, std::atoi(argv[4]), seconds, full);
    std::ofstream out(argv[2], std::ios::binary);
    out.write(reinterpret_cast<const char*>(seconds.data()),
              static_cast<std::streamsize>(seconds.size() * sizeof(double)));
    std::cout << without_pose << ' ' << full << '\n';
    return out.flush() ? 0 : 2;
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
