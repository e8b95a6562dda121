// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/pnp/observation.hpp"
#include "fairlead/tracker/estimate.hpp"
#include "fairlead/tracker/options.hpp"

namespace fairlead {

struct BatchView {
    std::int64_t stamp_ns = 0;
    std::span<const Observation> observations;
};

struct Refinement {
    std::vector<Estimate> estimates;  ///< one per view, in order; inlier_landmarks is empty
    std::vector<Vec3> X;              ///< refined landmarks [m]
    MatX covariance;                  ///< 3N x 3N [m^2]
    double noise_factor = 1.0;
    double prior_factor = 1.0;           ///< likely; the covariance is reported with it
    double prior_factor_believed = 1.0;  ///< the model is estimated with it
    double cost = 0.0;                   ///< negative log posterior at the optimum
    int iterations = 0;
    bool converged = false;
};

/// All views of a flight in one maximum a posteriori estimate of landmarks and poses, docs/estimator.md section 5. The
/// robust loss is graduated from wide to narrow; every view is tried again from other poses on the refined model, so
/// that it does not stay in a mirrored minimum. Throws std::invalid_argument for a bad camera, model, covariance or
/// option.
[[nodiscard]] Refinement refine(const Camera& camera, std::span<const Vec3> X0, const MatX& P0,
                                std::span<const BatchView> views, const TrackerOptions& options = {});

}  // namespace fairlead
