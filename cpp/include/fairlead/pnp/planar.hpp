// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/pnp/refine.hpp"

namespace fairlead::pnp {

/// The mirrored companion of T: the landmarks' principal plane reflected about the line of sight (the second minimum of
/// planar targets seen from afar, and the Necker reversal of thick ones), before refinement. docs/pnp.md eq. (6).
[[nodiscard]] SE3 mirrored(const SE3& T_camera_target, std::span<const Vec3> X_target,
                           std::span<const Observation> observations) noexcept;

struct PosePair {
    RefineResult best;
    RefineResult other;     ///< the second local minimum
    bool distinct = false;  ///< other.ok and it is a different minimum from best
};

/// Refines T and its mirror image; best is the one with the lower cost. docs/pnp.md section 4.
[[nodiscard]] PosePair pose_pair(const SE3& T_start, std::span<const Vec3> X_target,
                                 std::span<const Observation> observations, const Camera& camera,
                                 const Loss& loss) noexcept;

/// Ratio of the smallest to the middle singular value (flatness) and of the middle to the largest (straightness) of the
/// centred points that are observed: (0, .) is coplanar, (., 0) collinear.
struct Spread {
    double flatness = 0.0;
    double straightness = 0.0;
};
[[nodiscard]] Spread spread(std::span<const Vec3> X_target, std::span<const Observation> observations) noexcept;

}  // namespace fairlead::pnp
