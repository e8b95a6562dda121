// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/dense/cholesky.hpp"
#include "fairlead/window/landmark_prior.hpp"

namespace fairlead::window {

/// How far the told P0 is off, as a factor on it.
struct PriorFactors {
    double believed = 1.0;  ///< the smallest that the data allow: what the model is estimated with
    double likely = 1.0;    ///< the most probable: what its covariance is reported with
};

/// Evidence of the factor q of a model prior N(X0, q P0) given data of information A and score b at X0,
///   ev(q) = 1/2 b^T (A + P0^-1 / q)^-1 b - 1/2 log det(I + q P0 A),
/// docs/estimator.md eq. (16). Holds the memory for it.
class PriorEvidence {
  public:
    explicit PriorEvidence(int landmarks);

    /// A: lower triangle [1/m^2]; b: minus the gradient of the data's negative log likelihood at X0 [1/m].
    [[nodiscard]] PriorFactors evaluate(const LandmarkPrior& prior, const MatX& A, const VecX& b) noexcept;

  private:
    MatX S_;
    VecX y_;
    dense::Cholesky cholesky_;
};

/// Degrees of freedom with which the told P0 is believed.
inline constexpr double kPriorBelief = 10.0;
/// Half the log of how much less probable than the best the believed factor may be: two sigma.
inline constexpr double kCredibleNats = 2.0;

}  // namespace fairlead::window
