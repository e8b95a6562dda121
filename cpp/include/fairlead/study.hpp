// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fairlead/pnp/observation.hpp"
#include "fairlead/tracker/options.hpp"

/// Monte Carlo over the estimators: many simulated flights, each solved by several methods, in threads. docs/study.md.
namespace fairlead::study {

/// One simulated flight: what is true, what is told, and a first pose of every view from elsewhere.
struct Flight {
    std::vector<Vec3> X_true;  ///< [m]
    std::vector<Vec3> X0;      ///< the landmarks that are told [m]
    MatX P0;                   ///< their covariance [m^2]
    std::vector<std::int64_t> stamps_ns;
    std::vector<SE3> T_true;
    std::vector<SE3> T_start;  ///< NaN where there is none
    std::vector<std::vector<Observation>> views;
};

/// Throws std::invalid_argument unless every part of the flight has the size of the others.
void validate(const Flight& flight);

enum class Method {
    start,        ///< the poses that came with the flight
    single_view,  ///< from there, reprojection error minimised view by view on the told model
    free_window,  ///< landmarks and poses together without a prior: the published method, docs/baselines.md eq. (2)
    map,          ///< refine(): the whole flight in one batch with the prior
    online,       ///< Tracker: view by view
    true_model,   ///< PnP on the true landmarks, started at the true pose
    bound         ///< no estimator: the least covariances that one can have, docs/bound.md eq. (8)-(10)
};

/// What the publication leaves open.
struct FreeWindowOptions {
    int max_iterations = 2;
    double initial_damping = 1.0;  ///< of the first step, relative to the Hessian's diagonal
    double tolerance = 1e-9;       ///< stops when the predicted decrease is below this share of the cost
    bool refine_start = true;      ///< start from single-view poses instead of those that came
    bool pnp_after = true;         ///< poses by PnP on the landmarks found instead of those of the joint solve
};

struct Options {
    FreeWindowOptions free_window;
    TrackerOptions tracker;
};

/// What a method says of one flight. A pose that it has not is NaN, and so is its covariance.
struct Answer {
    std::vector<SE3> T_camera_target;
    std::vector<Mat66> covariances;  ///< of xi in T Exp(xi); start, single_view, free_window take the model as exact
    std::vector<Vec3> X;             ///< [m]
    MatX X_covariance;               ///< [m^2]; empty where the method says nothing of it
    double iterations = std::numeric_limits<double>::quiet_NaN();  ///< linear systems solved; NaN where none is counted
    double seconds = 0.0;                                          ///< processor time
};

/// One method on one flight.
[[nodiscard]] Answer solve(Method method, const Camera& camera, const Flight& flight, const Options& options);

/// One method on all flights, shared out among this many threads. Every flight is solved alone, so that the answers do
/// not depend on their number. Throws what solve() throws, for one of the flights that fail.
[[nodiscard]] std::vector<Answer> solve_all(Method method, const Camera& camera, std::span<const Flight> flights,
                                            const Options& options, int threads);

}  // namespace fairlead::study
