// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// What knows of the prior: batch, tracker, and the bound of both.
#include <limits>

#include "fairlead/refine.hpp"
#include "fairlead/tracker.hpp"
#include "fairlead/tracker/sanitise.hpp"
#include "fairlead/window/covariance.hpp"
#include "methods.hpp"

namespace fairlead::study {
namespace {

void put(const Estimate& estimate, std::size_t k, Answer& answer) {
    if (!estimate.ok()) return;
    answer.T_camera_target[k] = estimate.T_camera_target;
    answer.covariances[k] = estimate.covariance;
}

/// All views at the truth, least squares.
window::Problem problem_at_the_truth(const Camera& camera, const Flight& flight) {
    window::Problem problem;
    problem.camera = camera;
    problem.loss.threshold = std::numeric_limits<double>::infinity();
    problem.X = flight.X_true;
    problem.prior = window::make_prior(flight.X_true, flight.P0);
    std::vector<Observation> observations;
    observations.reserve(flight.X0.size());
    for (std::size_t k = 0; k < flight.views.size(); ++k) {
        sanitise(flight.views[k], problem.landmarks(), observations);
        window::ViewBlock block(problem.landmarks());
        block.state.T_camera_target = flight.T_true[k];
        for (const Observation& o : observations)
            block.measurements.push_back({o.landmark, o.z, o.covariance.inverse()});
        problem.views.push_back(std::move(block));
    }
    return problem;
}

}  // namespace

Answer map(const Camera& camera, const Flight& flight, const TrackerOptions& options) {
    std::vector<BatchView> views(flight.views.size());
    for (std::size_t k = 0; k < views.size(); ++k) {
        views[k].stamp_ns = flight.stamps_ns[k];
        views[k].observations = flight.views[k];
    }
    Refinement found = refine(camera, flight.X0, flight.P0, views, options);
    Answer answer = no_answer(flight);
    for (std::size_t k = 0; k < views.size(); ++k) put(found.estimates[k], k, answer);
    answer.X = std::move(found.X);
    answer.X_covariance = std::move(found.covariance);
    answer.iterations = found.iterations;
    return answer;
}

Answer online(const Camera& camera, const Flight& flight, const TrackerOptions& options) {
    Tracker tracker(camera, flight.X0, flight.P0, options);
    Answer answer = no_answer(flight);
    for (std::size_t k = 0; k < flight.views.size(); ++k)
        put(tracker.update(flight.stamps_ns[k], flight.views[k]), k, answer);
    answer.X.assign(tracker.landmarks().begin(), tracker.landmarks().end());
    answer.X_covariance = tracker.landmark_covariance();
    return answer;
}

Answer bound(const Camera& camera, const Flight& flight) {
    Answer answer = no_answer(flight);
    window::Problem problem = problem_at_the_truth(camera, flight);
    window::Workspace workspace(problem.landmarks());
    if (!window::linearise(problem) || !window::assemble_data(problem, 0.0, workspace)) return answer;
    window::scale_and_add_prior(problem, problem.X, workspace);
    if (!workspace.cholesky.factor(workspace.S)) return answer;
    answer.X_covariance.resizeLike(workspace.S);
    window::structure_covariance(problem, workspace, answer.X_covariance);
    MatX Yt(workspace.S.rows(), window::ViewState::kDim);
    MatX SigmaYt = Yt;
    for (std::size_t k = 0; k < problem.views.size(); ++k) {
        answer.T_camera_target[k] = flight.T_true[k];
        answer.covariances[k] =
            window::state_covariance(problem.views[k], problem.X, answer.X_covariance, 1.0, Yt, SigmaYt);
    }
    answer.X = flight.X_true;
    return answer;
}

}  // namespace fairlead::study
