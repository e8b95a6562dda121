// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// What is done view by view on a model that is taken as exact.
#include <Eigen/Cholesky>
#include <limits>

#include "methods.hpp"

namespace fairlead::study {
namespace {

constexpr Loss kLeastSquares{std::numeric_limits<double>::infinity()};

/// Every view refined from a pose of its own.
Answer each_view(const Camera& camera, const Flight& flight, std::span<const SE3> T_start, std::span<const Vec3> X,
                 const Loss& loss, int max_iterations) {
    Answer answer = no_answer(flight);
    answer.X.assign(X.begin(), X.end());
    answer.iterations = 0.0;
    for (std::size_t k = 0; k < flight.views.size(); ++k) {
        const pnp::RefineResult pose = pnp::refine(T_start[k], X, flight.views[k], camera, loss, max_iterations);
        answer.iterations += pose.iterations;
        put(pose, k, answer);
    }
    return answer;
}

}  // namespace

Answer no_answer(const Flight& flight) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    Answer answer;
    answer.T_camera_target.assign(flight.views.size(), {Mat33::Constant(nan), Vec3::Constant(nan)});
    answer.covariances.assign(flight.views.size(), Mat66::Constant(nan));
    answer.X = flight.X0;
    return answer;
}

void put(const pnp::RefineResult& pose, std::size_t k, Answer& answer) {
    const Eigen::LLT<Mat66> llt(pose.information);
    if (!pose.ok || llt.info() != Eigen::Success) return;
    const Mat66 covariance = llt.solve(Mat66::Identity());
    answer.T_camera_target[k] = pose.T_camera_target;
    answer.covariances[k] = 0.5 * (covariance + covariance.transpose());
}

Answer start(const Camera& camera, const Flight& flight) {
    return each_view(camera, flight, flight.T_start, flight.X0, kLeastSquares, 0);
}

Answer single_view(const Camera& camera, const Flight& flight) {
    return each_view(camera, flight, flight.T_start, flight.X0, kLeastSquares, 20);
}

Answer true_model(const Camera& camera, const Flight& flight, double loss_threshold) {
    return each_view(camera, flight, flight.T_true, flight.X_true, {loss_threshold}, 20);
}

}  // namespace fairlead::study
