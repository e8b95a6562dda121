// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

#include "fairlead/geometry/se3.hpp"

namespace fairlead::testing {

inline double largest(double a) { return std::abs(a); }
template <typename Derived>
double largest(const Eigen::MatrixBase<Derived>& A) {
    return A.size() == 0 ? 0.0 : A.cwiseAbs().template maxCoeff<Eigen::PropagateNaN>();
}

/// Central differences of f at x against J over a sweep of steps; the smallest relative error found.
/// Truncation falls and rounding grows as the step shrinks, so no single step fits all scales of f.
template <int Rows, int Columns, typename F>
double jacobian_error(const F& f, const Eigen::Matrix<double, Columns, 1>& x,
                      const Eigen::Matrix<double, Rows, Columns>& J) {
    double best = std::numeric_limits<double>::infinity();
    for (double relative = 1e-3; relative > 1e-9; relative *= 0.1) {
        Eigen::Matrix<double, Rows, Columns> numeric;
        for (int i = 0; i < Columns; ++i) {
            Eigen::Matrix<double, Columns, 1> forward = x, backward = x;
            const double step = relative * std::max(1.0, std::abs(x[i]));
            forward[i] += step;
            backward[i] -= step;
            numeric.col(i) = (f(forward) - f(backward)) / (2.0 * step);
        }
        best = std::min(best, (numeric - J).norm() / std::max(J.norm(), 1e-300));
    }
    return best;
}

/// Uniform and normal numbers from a seed (splitmix64), the same on every platform.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    double uniform(double low = 0.0, double high = 1.0) {
        return low + (high - low) * static_cast<double>(next() >> 11) * 0x1.0p-53;
    }
    double normal() {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
        return radius * std::cos(2.0 * 3.14159265358979323846 * uniform());
    }
    int below(int n) { return static_cast<int>(uniform() * n); }
    template <int N>
    Eigen::Matrix<double, N, 1> vector(double sigma = 1.0) {
        Eigen::Matrix<double, N, 1> v;
        for (int i = 0; i < N; ++i) v[i] = sigma * normal();
        return v;
    }
    /// Uniform over all rotations.
    Mat33 rotation() {
        const Eigen::Matrix<double, 4, 1> q = vector<4>().normalized();
        const Vec3 v = q.tail<3>();
        return (q[0] * q[0] - v.squaredNorm()) * Mat33::Identity() + 2.0 * v * v.transpose() + 2.0 * q[0] * so3::hat(v);
    }

  private:
    std::uint64_t next() {
        state_ += 0x9e3779b97f4a7c15ULL;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

}  // namespace fairlead::testing

/// Largest absolute difference of two scalars or two matrices is at most the tolerance. NaN fails.
#define CHECK_NEAR(a, b, tolerance)                                                                              \
    do {                                                                                                         \
        const double largest_difference = fairlead::testing::largest((a) - (b));                                 \
        BOOST_CHECK_MESSAGE(largest_difference <= (tolerance), #a " and " #b " differ by " << largest_difference \
                                                                                           << "\n"               \
                                                                                           << (a) << "\nand\n"   \
                                                                                           << (b));              \
    } while (false)

/// The derivative J of f at x agrees with central differences to 1e-6.
#define CHECK_JACOBIAN(f, x, J)                                                                                      \
    do {                                                                                                             \
        const double relative_error = fairlead::testing::jacobian_error((f), (x), (J));                              \
        BOOST_CHECK_MESSAGE(relative_error < 1e-6, "relative error of " #J " is " << relative_error << "\n" << (J)); \
    } while (false)
