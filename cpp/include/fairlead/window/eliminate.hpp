// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/dense/rank_update.hpp"
#include "fairlead/window/state.hpp"

namespace fairlead::window {

/// Cholesky factor of H + damping diag(H), inverted in place into view.L_inverse. False if not positive definite.
[[nodiscard]] bool factor_state(double damping, ViewBlock& view) noexcept;

/// Rows of one landmark in the eliminated system: Y_j^T = M_j E_j L^-T with E_j = [I, -hat(X_j)] (3 x 6),
/// docs/estimator.md eq. (8).
[[nodiscard]] StateByPoint reduced_rows(const ViewBlock& view, const PointTerm& term, const Vec3& X) noexcept;

/// State step that belongs to a structure step dX: -(H + damping)^-1 (g + H_px dX), eq. (9).
/// Step of what a term sees: the landmark's own, and that of a bias along the line of sight.
[[nodiscard]] Vec3 point_step(const PointTerm& term, const VecX& dX) noexcept;

[[nodiscard]] StateVector back_substitute(const ViewBlock& view, std::span<const Vec3> X_target,
                                          const VecX& dX) noexcept;

/// Adds many eliminated views to a dense structure system, a chunk at a time: S -= sum Y^T Y (lower triangle), g -= sum
/// Y^T y.
class Eliminator {
  public:
    explicit Eliminator(int landmarks);
    void add(const ViewBlock& view, std::span<const Vec3> X_target, MatX& S, VecX& g) noexcept;
    void flush(MatX& S) noexcept;

  private:
    dense::RankUpdate Y_;
};

}  // namespace fairlead::window
