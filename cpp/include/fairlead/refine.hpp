// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/motion/tie.hpp"
#include "fairlead/pnp/observation.hpp"
#include "fairlead/tracker/entries.hpp"
#include "fairlead/tracker/estimate.hpp"
#include "fairlead/tracker/options.hpp"
#include "fairlead/window/problem.hpp"

namespace fairlead {

struct BatchView {
    std::int64_t stamp_ns = 0;
    std::span<const Observation> observations;
};

/// What else is known of a flight, docs/range.md and docs/motion.md. Stamps in any order.
struct BatchReadings {
    struct Range {
        std::int64_t stamp_ns = 0;
        window::RangeMeasurement range;  ///< to a landmark, or to the target's origin (kOrigin)
    };
    struct Attitude {
        std::int64_t stamp_ns = 0;
        motion::Attitude attitude;
    };
    std::vector<window::LengthMeasurement> lengths;
    std::vector<Range> ranges;
    std::vector<Attitude> attitudes;
};

/// Owns what its estimates point to, so it moves but does not copy.
struct Refinement {
    Refinement() = default;
    Refinement(Refinement&&) = default;
    Refinement& operator=(Refinement&&) = default;

    std::vector<Estimate> estimates;        ///< one per view, in order
    std::vector<std::vector<int>> inliers;  ///< landmarks of each view that passed its gate: their inlier_landmarks
    std::vector<Vec3> X;                    ///< refined landmarks [m]
    MatX covariance;                        ///< 3N x 3N [m^2]
    double noise_factor = 1.0;
    double prior_factor = 1.0;           ///< likely; the covariance is reported with it
    double prior_factor_believed = 1.0;  ///< the model is estimated with it
    double cost = 0.0;                   ///< negative log posterior at the optimum
    int iterations = 0;
    bool converged = false;
    int ranges_believed = 0, ranges_refused = 0;
    RangeBias range_bias;  ///< if the options ask for it
};

/// All views of a flight in one maximum a posteriori estimate of landmarks and poses, docs/estimator.md section 5. The
/// robust loss is graduated from wide to narrow; every view is tried again from other poses on the refined model, so
/// that it does not stay in a mirrored minimum. Where options.motion says what is smooth, a last stage puts all views
/// on one path. Throws std::invalid_argument for a bad camera, model, covariance, option or reading.
[[nodiscard]] Refinement refine(const Camera& camera, std::span<const Vec3> X0, const MatX& P0,
                                std::span<const BatchView> views, const TrackerOptions& options = {},
                                const BatchReadings& readings = {});

}  // namespace fairlead
