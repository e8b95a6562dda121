// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace fairlead {

/// Robust loss of the whitened squared residual s = r^T S^-1 r [-], docs/robust.md eq. (1):
///   rho(s) = s                    for s <= a
///   rho(s) = a (2 - a / s)        for s >  a        (Geman-McClure tail: bounded by 2 a)
/// Quadratic, hence fully efficient, on inliers; redescending beyond a. a = infinity is least squares.
struct Loss {
    double threshold = 9.21034037197618;  ///< a [-]: the 99 % point of chi-square with 2 degrees of freedom

    [[nodiscard]] double rho(double s) const noexcept { return s <= threshold ? s : threshold * (2.0 - threshold / s); }

    /// w = rho'(s); the Gauss-Newton weight, docs/robust.md eq. (2).
    [[nodiscard]] double weight(double s) const noexcept {
        if (s <= threshold) return 1.0;
        const double ratio = threshold / s;
        return ratio * ratio;
    }

    /// What an observation costs that no pose in front of the camera can explain: the supremum 2 a of rho.
    [[nodiscard]] double bound() const noexcept { return 2.0 * threshold; }
};

/// Throws std::invalid_argument unless threshold > 0 (infinity allowed).
void validate(const Loss& loss);

}  // namespace fairlead
