// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/window/problem.hpp"

namespace fairlead::window {

/// Sigma_X = S^-1, the covariance of all landmarks with every view's state integrated out; workspace.llt must hold S
/// undamped.
void structure_covariance(const Workspace& workspace, MatX& Sigma) noexcept;

/// Covariance of a view's xi with the structure's uncertainty in it, docs/estimator.md eq. (10):
///   f L^-T L^-1 + L^-T Y Sigma_X Y^T L^-1.  Y is scratch (6 x 3N transposed).
[[nodiscard]] StateMatrix state_covariance(const ViewBlock& view, std::span<const Vec3> X_target, const MatX& Sigma,
                                           double noise_factor, MatX& Yt, MatX& SigmaYt) noexcept;

/// Variance components (Foerstner 1979; MacKay 1992 eq. (2.24)): how far the told noise and the told prior were off,
/// each pulled towards 1 with the weight of kNoiseBelief and kPriorBelief degrees of freedom, docs/estimator.md eq.
/// (14)-(15).
void update_factors(Problem& problem, const MatX& Sigma) noexcept;

inline constexpr double kNoiseBelief = 20.0;
inline constexpr double kPriorBelief = 10.0;

}  // namespace fairlead::window
