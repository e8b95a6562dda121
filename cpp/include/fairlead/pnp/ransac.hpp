// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "fairlead/pnp/refine.hpp"

namespace fairlead::pnp {

struct RansacOptions {
    int max_iterations = 200;
    double confidence = 0.9999;
    std::uint64_t seed = 0;
};

struct RansacResult {
    RefineResult pose;  ///< refined on the consensus set with the loss given
    int iterations = 0;
    bool ok = false;  ///< at least 4 inliers and pose.ok
};

/// P3P hypotheses scored by sum rho(s) (a bounded loss makes this MSAC) over all observations, local optimisation of
/// each new best, adaptive stopping (Fischler and Bolles 1981; Chum et al. 2003). Deterministic for a seed; allocates
/// nothing. docs/pnp.md section 2.
[[nodiscard]] RansacResult ransac(std::span<const Vec3> X_target, std::span<const Observation> observations,
                                  const Camera& camera, const Loss& loss, const RansacOptions& options = {}) noexcept;

}  // namespace fairlead::pnp
