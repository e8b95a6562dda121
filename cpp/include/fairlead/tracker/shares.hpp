// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
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

/// What each view says that those before it did not, where a detector errs alike in views that are alike,
/// docs/motion.md eq. (12) and (15): shares with which the sum of all information is as uncertain as it claims.
///
/// Places a tenth of a correlation length apart stand for the views near them, so that memory is bounded.
class Shares {
  public:
    explicit Shares(const TrackerOptions& options) noexcept;

    /// Share of a view; takes nothing in.
    [[nodiscard]] double of(const Outlook& view) noexcept;
    /// Takes in the view whose share was last asked for.
    void take() noexcept;

  private:
    static constexpr std::size_t kCapacity = 128;
    struct Place {
        Outlook outlook;
        double given = 0.0;  ///< sum of share / range of the views near it
    };
    [[nodiscard]] double likeness(const Outlook& a, const Outlook& b) const noexcept;
    void make_room() noexcept;

    double per_second_ = 0.0, per_radian_ = 0.0, per_log_range_ = 0.0;
    bool white_ = true;
    std::array<Place, kCapacity> places_;  ///< in the order of time
    std::size_t n_ = 0;

    Outlook newest_;
    double share_ = 1.0, most_alike_ = 0.0;
    std::size_t nearest_ = 0;
};

}  // namespace fairlead
