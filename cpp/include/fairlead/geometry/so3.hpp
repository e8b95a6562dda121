// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/geometry/types.hpp"

namespace fairlead::so3 {

/// hat(a) b = a x b.
[[nodiscard]] inline Mat33 hat(const Vec3& a) noexcept {
    Mat33 A;
    A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
    return A;
}

/// A hat(b), column by column: nothing is multiplied by the zeros.
template <typename Derived>
[[nodiscard]] auto times_hat(const Eigen::MatrixBase<Derived>& A, const Vec3& b) noexcept {
    Eigen::Matrix<double, Derived::RowsAtCompileTime, 3> product;
    product.col(0) = b.z() * A.col(1) - b.y() * A.col(2);
    product.col(1) = b.x() * A.col(2) - b.z() * A.col(0);
    product.col(2) = b.y() * A.col(0) - b.x() * A.col(1);
    return product;
}

/// Exp: rotation by |phi| about phi, Rodrigues' formula, CONVENTIONS.md eq. (4); exact series near zero.
[[nodiscard]] Mat33 exp(const Vec3& phi) noexcept;

/// Inverse of exp, |phi| <= pi, stable at 0 and at pi.
[[nodiscard]] Vec3 log(const Mat33& R) noexcept;

/// V(phi) = int_0^1 Exp(s phi) ds (the left Jacobian), CONVENTIONS.md eq. (5).
[[nodiscard]] Mat33 left_jacobian(const Vec3& phi) noexcept;

/// The rotation nearest to M in the Frobenius norm.
[[nodiscard]] Mat33 nearest(const Mat33& M) noexcept;

}  // namespace fairlead::so3
