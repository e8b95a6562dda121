// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fairlead/motion/tie.hpp"
#include "fairlead/tracker/options.hpp"
#include "fairlead/tracker/range_gate.hpp"
#include "fairlead/window/problem.hpp"

namespace fairlead {

/// Throws std::invalid_argument "what: got ..., expected ...".
void require(bool good, const std::string& what, const std::string& got, const std::string& expected);
void require_positive(double value, const std::string& what);
[[nodiscard]] bool is_rotation(const Mat33& R) noexcept;
void require_attitude(const motion::Attitude& attitude);
void require_length(const window::LengthMeasurement& length, int landmarks);

inline constexpr double kMaxRangeAge = 0.5;     ///< [s] between a range and the view it is used with
inline constexpr double kMaxAttitudeAge = 0.1;  ///< [s] the same of an attitude

/// What other sensors said since the last view.
class Readings {
  public:
    /// Both throw std::invalid_argument for numbers that mean nothing.
    void add_range(std::int64_t stamp_ns, const window::RangeMeasurement& range);
    void add_attitude(std::int64_t stamp_ns, const motion::Attitude& attitude);

    /// The ranges that are believed, moved to the view's stamp by the closing speed, which may be off by this share of
    /// itself; docs/range.md eq. (1). Valid until the next call.
    [[nodiscard]] std::span<const window::RangeMeasurement> ranges_at(std::int64_t stamp_ns, double rate,
                                                                      double rate_share) noexcept;
    [[nodiscard]] std::optional<motion::Attitude> attitude_at(std::int64_t stamp_ns) const noexcept;

    [[nodiscard]] int believed() const noexcept { return believed_; }
    [[nodiscard]] int refused() const noexcept { return refused_; }

  private:
    static constexpr std::size_t kMax = window::ViewBlock::kMaxRanges;
    struct StampedRange {
        std::int64_t stamp_ns = 0;
        window::RangeMeasurement range;
    };

    std::array<StampedRange, kMax> pending_;
    std::size_t n_pending_ = 0;
    std::array<window::RangeMeasurement, kMax> taken_;
    RangeGate gate_;
    int believed_ = 0, refused_ = 0;
    std::int64_t attitude_ns_ = 0;
    std::optional<motion::Attitude> attitude_;
};

}  // namespace fairlead
