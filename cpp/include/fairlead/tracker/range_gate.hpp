// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "fairlead/geometry/types.hpp"

namespace fairlead {

/// Which readings of a range finder to believe: those that agree with the readings before them, docs/range.md eq. (2).
///
/// The readings alone are followed by a Kalman filter of distance and closing speed; it starts with four readings that
/// lie on a line in time, and starts anew after three in a row that it did not believe. The images have no say, so that
/// a wrong model cannot turn away a true range.
class RangeGate {
  public:
    [[nodiscard]] bool admit(std::int64_t stamp_ns, double range_m, double sigma_m) noexcept;

  private:
    struct Reading {
        std::int64_t stamp_ns = 0;
        double range_m = 0.0, sigma_m = 1.0;
    };
    [[nodiscard]] bool start(const Reading& reading) noexcept;

    std::array<Reading, 5> recent_;
    int filled_ = 0;
    bool started_ = false;
    int refused_ = 0;
    std::int64_t stamp_ns_ = 0;
    Vec2 mean_ = Vec2::Zero();
    Mat22 covariance_ = Mat22::Identity();
};

}  // namespace fairlead
