// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// The published joint optimisation over all views of a flight, docs/baselines.md section 3, without a prior.
#include <limits>

#include "fairlead/tracker/sanitise.hpp"
#include "fairlead/window/levenberg_marquardt.hpp"
#include "methods.hpp"

namespace fairlead::study {
namespace {

constexpr Loss kLeastSquares{std::numeric_limits<double>::infinity()};
constexpr int kPnpIterations = 20;

/// The views that have a pose, and the landmarks that at least two of them see: no other can move.
struct Part {
    window::Problem problem;
    std::vector<std::size_t> landmarks;  ///< of the problem, in the target
    std::vector<std::size_t> views;      ///< of the problem, in the flight
};

std::vector<int> numbers_of_seen_twice(std::span<const std::vector<Observation>> views,
                                       std::span<const pnp::RefineResult> first, Part& part, std::size_t landmarks) {
    std::vector<int> seen(landmarks, 0);
    std::vector<int> number(landmarks, -1);
    for (std::size_t k = 0; k < views.size(); ++k)
        if (first[k].ok)
            for (const Observation& o : views[k]) ++seen[static_cast<std::size_t>(o.landmark)];
    for (std::size_t j = 0; j < landmarks; ++j) {
        if (seen[j] < 2) continue;
        number[j] = static_cast<int>(part.landmarks.size());
        part.landmarks.push_back(j);
    }
    return number;
}

Part assemble(const Camera& camera, const Flight& flight, std::span<const std::vector<Observation>> views,
              std::span<const pnp::RefineResult> first) {
    Part part;
    part.problem.camera = camera;
    part.problem.loss = kLeastSquares;
    const std::vector<int> number = numbers_of_seen_twice(views, first, part, flight.X0.size());
    for (const std::size_t j : part.landmarks) part.problem.X.push_back(flight.X0[j]);
    for (std::size_t k = 0; k < views.size(); ++k) {
        if (!first[k].ok) continue;
        window::ViewBlock block(part.problem.landmarks());
        block.state.T_camera_target = first[k].T_camera_target;
        for (const Observation& o : views[k]) {
            const int j = number[static_cast<std::size_t>(o.landmark)];
            if (j >= 0) block.measurements.push_back({j, o.z, o.covariance.inverse()});
        }
        if (block.measurements.size() < 4) continue;
        part.problem.views.push_back(std::move(block));
        part.views.push_back(k);
    }
    return part;
}

/// Puts the landmarks and poses of the joint solve in place; returns the iterations, 0 if it failed.
int solve_together(Part& part, const FreeWindowOptions& options, std::vector<Vec3>& X, std::vector<SE3>& T) {
    if (part.views.size() < 2 || part.landmarks.size() < 4) return 0;
    window::Workspace workspace(part.problem.landmarks());
    const window::LmSummary summary = window::levenberg_marquardt(part.problem,
                                                                  {.max_iterations = options.max_iterations,
                                                                   .initial_damping = options.initial_damping,
                                                                   .tolerance = options.tolerance},
                                                                  workspace);
    if (!summary.ok) return 0;
    for (std::size_t i = 0; i < part.landmarks.size(); ++i) X[part.landmarks[i]] = part.problem.X[i];
    for (std::size_t i = 0; i < part.views.size(); ++i) T[part.views[i]] = part.problem.views[i].state.T_camera_target;
    return summary.iterations;
}

}  // namespace

Answer free_window(const Camera& camera, const Flight& flight, const FreeWindowOptions& options) {
    Answer answer = no_answer(flight);
    std::vector<std::vector<Observation>> views(flight.views.size());
    std::vector<pnp::RefineResult> first(flight.views.size());
    std::vector<SE3> T = flight.T_start;
    const auto pnp = [&](const SE3& T_from, std::size_t k, int iterations) {
        return pnp::refine(T_from, answer.X, views[k], camera, kLeastSquares, iterations);
    };
    for (std::size_t k = 0; k < views.size(); ++k) {
        views[k].reserve(flight.X0.size());
        sanitise(flight.views[k], static_cast<int>(flight.X0.size()), views[k]);
        first[k] = pnp(flight.T_start[k], k, options.refine_start ? kPnpIterations : 0);
        if (first[k].ok) T[k] = first[k].T_camera_target;
    }
    Part part = assemble(camera, flight, views, first);
    answer.iterations = solve_together(part, options, answer.X, T);
    for (std::size_t k = 0; k < views.size(); ++k) {
        pnp::RefineResult best = pnp(T[k], k, options.pnp_after ? kPnpIterations : 0);
        if (options.pnp_after) {
            const pnp::RefineResult other = pnp(first[k].T_camera_target, k, kPnpIterations);
            if (other.ok && (!best.ok || other.cost < best.cost)) best = other;
        }
        put(best, k, answer);
    }
    return answer;
}

}  // namespace fairlead::study
