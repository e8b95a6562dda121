// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "fairlead/dense/cholesky.hpp"
#include "fairlead/robust/loss.hpp"
#include "fairlead/window/compressed_views.hpp"
#include "fairlead/window/eliminate.hpp"
#include "fairlead/window/linearise.hpp"
#include "fairlead/window/prior_evidence.hpp"

namespace fairlead::window {

/// A measured distance between two landmarks, |X_a - X_b|.
struct LengthMeasurement {
    int a = -1, b = -1;
    double length_m = 0.0;
    double sigma_m = 1.0;
};

/// The negative log posterior of landmarks X and view states T_k, docs/estimator.md eq. (1) and (3):
///   E = 1/2 [ (sum_k sum_j rho(s_kj) + compressed views) / noise_factor + d(X)^T P0^-1 d(X) / believed
///             + sum of known distances ((|X_a - X_b| - length) / sigma)^2 ].
struct Problem {
    Camera camera;
    std::optional<LandmarkPrior> prior;
    std::vector<CompressedViews> compressed;  ///< views that left the window, by their gauge
    std::optional<CompressedViews> path;      ///< what a motion prior makes of the views on it, without their motion
    std::vector<LengthMeasurement> lengths;
    std::vector<Vec3> X;  ///< landmarks, target frame [m]
    std::vector<ViewBlock> views;
    double noise_factor = 1.0;   ///< multiplies every told covariance
    double design_effect = 1.0;  ///< by which errors that its landmarks share widen the pose of a view
    double pose_factor = 1.0;  ///< multiplies the covariance of what one view says of its pose, docs/motion.md eq. (17)
    PriorFactors prior_factors;  ///< of P0; `believed` multiplies it in E
    Loss loss;                   ///< threshold in units of the estimated noise

    [[nodiscard]] int landmarks() const noexcept { return static_cast<int>(X.size()); }
    /// The loss in told units: rho_f(s) = f rho(s / f).
    [[nodiscard]] Loss told_loss() const noexcept { return {loss.threshold * noise_factor}; }
};

/// What views say of the landmarks, as a quadratic: told units, states eliminated, without the prior.
struct Quadratic {
    MatX H;  ///< 3N x 3N, lower triangle
    VecX g;  ///< gradient at X
    std::vector<Vec3> X;
};

/// The normal equations with all states eliminated: S dX = -g.
struct Workspace {
    explicit Workspace(int landmarks);

    Eliminator eliminator;
    MatX S;  ///< 3N x 3N, lower triangle
    VecX g, dX, D, step, pulled;
    dense::Cholesky cholesky;  ///< of S
    MatX product;              ///< scratch
    PriorEvidence evidence;
    std::vector<StateVector> dT;
    std::vector<Vec3> X_before;  ///< where the last step was taken from
    std::vector<SE3> T_before;
};

/// Value of E at the current estimate, where its views are linearised.
[[nodiscard]] double posterior_cost(Problem& problem) noexcept;

/// Linearises all views and compressed views at the current estimate. False if a view has become unusable.
[[nodiscard]] bool linearise(Problem& problem) noexcept;

/// Assembles the data's part of S, g and the damping diagonal D in told units, states eliminated with damping; false if
/// a state is singular.
[[nodiscard]] bool assemble_data(Problem& problem, double damping, Workspace& workspace) noexcept;

/// S and g of the quadratic, at other landmarks.
void assemble(const Quadratic& data, std::span<const Vec3> X, Workspace& workspace) noexcept;

/// Divides the data's part by the noise factor and adds the prior and the known distances at X: the system of E itself.
void scale_and_add_prior(const Problem& problem, std::span<const Vec3> X, Workspace& workspace) noexcept;

}  // namespace fairlead::window
