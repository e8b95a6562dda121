// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cstdint>
#include <span>

#include "fairlead/geometry/se3.hpp"
#include "fairlead/tracker/options.hpp"

namespace fairlead {

/// Where a view looks from, and when: what decides how much its errors are like those of another.
struct Outlook {
    std::int64_t stamp_ns = 0;
    Vec3 direction = Vec3::UnitX();  ///< from the model's centroid to the camera, target frame
    double log_range = 0.0;
};

[[nodiscard]] Outlook outlook(std::int64_t stamp_ns, const SE3& T_camera_target, std::span<const Vec3> X) noexcept;

/// What each view says that those before it did not, where a detector errs alike in views that are alike, docs/motion.md
/// eq. (12)-(13).
///
/// All views together are worth n = 1^T K^-1 1 independent ones, K their correlations; a view's share is what it adds.
/// Few views stand for all in K, a quarter of a correlation length apart. What a view between them adds is given in
/// advance of the next of them, so that a camera that hovers, or comes back, gets nothing twice.
class Shares {
  public:
    explicit Shares(const TrackerOptions& options) noexcept;

    /// Share of a view; takes nothing in.
    [[nodiscard]] double of(const Outlook& view) noexcept;
    /// Takes in the view whose share was last asked for.
    void take() noexcept;

  private:
    static constexpr int kCapacity = 64;
    [[nodiscard]] double likeness(const Outlook& a, const Outlook& b) const noexcept;
    void make_room() noexcept;
    void append() noexcept;

    double per_second_ = 0.0, per_radian_ = 0.0, per_log_range_ = 0.0;
    bool white_ = true;
    std::array<Outlook, kCapacity> anchors_;
    int n_ = 0;
    Eigen::Matrix<double, kCapacity, kCapacity> L_;  ///< Cholesky factor of K
    Eigen::Matrix<double, kCapacity, 1> z_, row_;    ///< L^-1 1 and L^-1 k of the newest view
    double advance_ = 0.0;                           ///< given to views that do not stand for others

    Outlook newest_;
    double most_alike_ = 0.0, rest_ = 1.0, news_ = 1.0;
};

}  // namespace fairlead
