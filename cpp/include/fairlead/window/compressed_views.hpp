// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/window/slice.hpp"
#include "fairlead/window/state.hpp"

namespace fairlead::window {

/// What views that left the window still say about the model.
///
/// A view with its pose eliminated is a quadratic in the model with a null space of seven directions N(X), which turns
/// with X. Sums of quadratics taken at different X would lose it and invent knowledge of the model's orientation. So
/// the sum is kept in the shape y = S(X) X, the model aligned onto the first one: E(X) = 1/2 u^T Lambda u - eta^T u +
/// c, u = y(X) - X_ref, docs/estimator.md eq. (11). It is invariant under the gauge of X, exactly and for ever.
class CompressedViews {
  public:
    explicit CompressedViews(const Reference& reference);

    /// Takes a view linearised at X (told covariances, robust weights frozen) with its state factored.
    void add(const ViewBlock& view, std::span<const Vec3> X) noexcept;

    /// Holds scale * (u^T Lambda u - 2 eta^T u) and nothing else.
    void replace(const MatX& Lambda, const VecX& eta, double scale) noexcept;
    /// Adds the same.
    void add(const MatX& Lambda, const VecX& eta, double scale) noexcept;

    /// Hessian (both triangles) and gradient with respect to X, value at X; all twice-negative-log units of sum rho,
    /// i.e. E = value / 2.
    void linearise(std::span<const Vec3> X) noexcept;
    [[nodiscard]] double value(std::span<const Vec3> X) noexcept;

    [[nodiscard]] const MatX& hessian() const noexcept { return hessian_; }
    [[nodiscard]] const VecX& gradient() const noexcept { return gradient_; }
    [[nodiscard]] double views() const noexcept { return views_; }  ///< sum of their shares
    [[nodiscard]] bool empty() const noexcept { return empty_; }
    [[nodiscard]] double inliers() const noexcept { return inliers_; }  ///< the same of their inliers

  private:
    void add_bias(const PointTerm& term, const StateByPoint& rows, const Vec3& gradient) noexcept;

    Slice slice_;
    MatX Lambda_;
    VecX eta_;
    double constant_ = 0.0;
    double views_ = 0.0;
    bool empty_ = true;
    double inliers_ = 0.0;

    MatX hessian_, A_;
    VecX gradient_, q_;
};

}  // namespace fairlead::window
