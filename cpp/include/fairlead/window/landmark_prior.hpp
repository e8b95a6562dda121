// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/geometry/types.hpp"

namespace fairlead::window {

/// Covariance of a roughly known model, docs/estimator.md eq. (2):
///   P0 = diag(sigma^2) + scale_sigma^2 x0 x0^T,  x0 = X0 about its centroid.
/// sigma holds three standard deviations per landmark [m]; scale_sigma [-] is the common error of scale.
[[nodiscard]] MatX landmark_covariance(std::span<const Vec3> X0, std::span<const Vec3> sigma, double scale_sigma);

/// d(X) ~ N(0, alpha P0) with d the difference of X from the told landmarks in the told ones' size, docs/estimator.md
/// eq. (2); the last entries may be no landmarks, but N(0, P0) whatever alpha is.
struct LandmarkPrior {
    /// Throws nothing; `aside` has 3N entries.
    LandmarkPrior(VecX mean, MatX information, VecX aside);

    VecX mean;         ///< 3N [m], landmark-major
    MatX information;  ///< 3N x 3N [1/m^2]
    VecX aside;        ///< 3N [1/m^2], about zero: of the entries that are no landmarks, which no factor scales

    VecX outline;              ///< x0, 3N [m]: the told landmarks about their middle
    VecX pull;                 ///< P0^-1 x0 [1/m]
    double scale_information;  ///< x0^T P0^-1 x0 [-]: of the scale that is common to all landmarks

    [[nodiscard]] int landmarks() const noexcept { return static_cast<int>(mean.size() / 3); }
    /// s of X as x0 and P0 see it; 1 is the told size.
    [[nodiscard]] double scale(std::span<const Vec3> X) const noexcept;
};

/// Throws std::invalid_argument unless the covariance is symmetric, finite and positive semidefinite. Directions
/// without variance (a landmark with sigma 0 is fixed) get kFixedSigma of the model's extent, so that the information
/// stays finite. The last `aside` entries are no landmarks; of their covariance the diagonal counts.
[[nodiscard]] LandmarkPrior make_prior(std::span<const Vec3> X0, const MatX& covariance, int aside = 0);

/// Squared Mahalanobis distance d^T P0^-1 d [-]. Allocates nothing.
[[nodiscard]] double squared_distance(const LandmarkPrior& prior, std::span<const Vec3> X) noexcept;

/// The same of what is set aside, sum x^2 / P0.
[[nodiscard]] double aside_cost(const LandmarkPrior& prior, std::span<const Vec3> X) noexcept;

/// Standard deviation of what is held fixed, in units of the model's extent.
inline constexpr double kFixedSigma = 1e-6;

}  // namespace fairlead::window
