// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fairlead/dense/panels.hpp"
#include "fairlead/geometry/types.hpp"

namespace fairlead::dense {

/// A = L L^T of a symmetric positive definite matrix of some tens to hundreds of rows, four columns at a time from the
/// left (Golub and Van Loan 2013, section 4.2.5). All memory is taken at construction.
class Cholesky {
  public:
    explicit Cholesky(int rows);

    /// Of the lower triangle of A. False, and the factor void, if A is not positive definite.
    [[nodiscard]] bool factor(const MatX& A) noexcept;

    [[nodiscard]] auto L() const noexcept { return L_.triangularView<Eigen::Lower>(); }
    [[nodiscard]] auto L_transposed() const noexcept { return L_.transpose().triangularView<Eigen::Upper>(); }
    /// 1/2 log det A.
    [[nodiscard]] double half_log_det() const noexcept { return L_.diagonal().array().log().sum(); }
    /// B <- A^-1 B.
    template <typename Columns>
    void solve_in_place(Eigen::MatrixBase<Columns>& B) const noexcept {
        L().solveInPlace(B);
        L_transposed().solveInPlace(B);
    }

  private:
    bool factor_columns(int j) noexcept;

    int rows_;
    Panels panels_;
    MatX L_;
};

}  // namespace fairlead::dense
