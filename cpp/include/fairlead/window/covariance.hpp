// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/window/problem.hpp"

namespace fairlead::window {

/// Covariance of all landmarks with every view's state integrated out, for a prior that was believed with one factor
/// and is likely to have another, docs/estimator.md eq. (17); workspace.cholesky must hold that of S undamped. Returns
/// the number of directions of the model that the data determine, eq. (14).
double structure_covariance(const Problem& problem, Workspace& workspace, MatX& Sigma) noexcept;

/// Covariance of a view's xi with the structure's uncertainty in it, docs/estimator.md eq. (10), f the pose factor:
///   f L^-T L^-1 + L^-T Y Sigma_X Y^T L^-1.  Y is scratch (6 x 3N transposed).
[[nodiscard]] StateMatrix state_covariance(const ViewBlock& view, std::span<const Vec3> X_target, const MatX& Sigma,
                                           double pose_factor, MatX& Yt, MatX& SigmaYt) noexcept;

/// Variance component of the told noise (Foerstner 1979), pulled towards 1 with the weight of kNoiseBelief degrees of
/// freedom, docs/estimator.md eq. (14); what landmarks share leaves no residual but widens poses, docs/motion.md eq.
/// (17). `determined` directions of the model are taken off.
void update_noise_factor(Problem& problem, double determined) noexcept;

/// How far the told prior is off: PriorEvidence at the data's quadratic, docs/estimator.md eq. (16).
void update_prior_factors(Problem& problem, const Quadratic& data, Workspace& workspace) noexcept;

/// Whether the model was corrected by more than what was told of it allows: its squared distance from the prior beyond
/// the 99.99 % point of chi-square with as many degrees of freedom as directions are determined, docs/estimator.md eq.
/// (25).
[[nodiscard]] bool contradicts_prior(const Problem& problem, double determined) noexcept;

inline constexpr double kNoiseBelief = 20.0;

}  // namespace fairlead::window
