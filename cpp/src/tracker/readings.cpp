// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/readings.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fairlead {
namespace {

double seconds(std::int64_t ns) noexcept { return 1e-9 * static_cast<double>(ns); }

}  // namespace

void require(bool good, const std::string& what, const std::string& got, const std::string& expected) {
    if (!good) throw std::invalid_argument(what + ": got " + got + ", expected " + expected);
}

void require_positive(double value, const std::string& what) {
    require(value > 0.0 && std::isfinite(value), what, std::to_string(value), "a positive number");
}

bool is_rotation(const Mat33& R) noexcept {
    return R.allFinite() && (R.transpose() * R - Mat33::Identity()).norm() < 1e-6 && R.determinant() > 0.0;
}

void require_attitude(const motion::Attitude& attitude) {
    require(is_rotation(attitude.R_world_camera), "R_world_camera", "another matrix", "a rotation");
    require(attitude.sigma_rad >= 0.0 && std::isfinite(attitude.sigma_rad), "sigma_rad",
            std::to_string(attitude.sigma_rad), "zero or more");
}

void require_length(const window::LengthMeasurement& length, int landmarks) {
    const auto& [a, b, length_m, sigma_m] = length;
    require(a >= 0 && b >= 0 && a < landmarks && b < landmarks && a != b, "length between",
            std::to_string(a) + " and " + std::to_string(b), "two landmarks of " + std::to_string(landmarks));
    require_positive(length_m, "length_m");
    require_positive(sigma_m, "sigma_m");
}

void Readings::add_range(std::int64_t stamp_ns, const window::RangeMeasurement& range) {
    require_positive(range.range_m, "range_m");
    require_positive(range.sigma_m, "sigma_m");
    if (n_pending_ == kMax) std::rotate(pending_.begin(), pending_.begin() + 1, pending_.end());
    n_pending_ = std::min(n_pending_ + 1, kMax);
    pending_[n_pending_ - 1] = {stamp_ns, range};
}

void Readings::add_attitude(std::int64_t stamp_ns, const motion::Attitude& attitude) {
    require_attitude(attitude);
    attitude_ns_ = stamp_ns;
    attitude_ = attitude;
}

std::span<const window::RangeMeasurement> Readings::ranges_at(std::int64_t stamp_ns, double rate,
                                                              double rate_share) noexcept {
    std::size_t n = 0;
    for (std::size_t i = 0; i < n_pending_; ++i) {
        const auto& [at_ns, range] = pending_[i];
        const double dt = seconds(stamp_ns - at_ns);
        if (std::abs(dt) > kMaxRangeAge || !gate_.admit(at_ns, range.range_m, range.sigma_m)) {
            ++refused_;
            continue;
        }
        ++believed_;
        taken_[n] = range;
        taken_[n].range_m += rate * dt;
        taken_[n++].sigma_m = std::hypot(range.sigma_m, rate_share * rate * dt);
    }
    n_pending_ = 0;
    return {taken_.data(), n};
}

std::optional<motion::Attitude> Readings::attitude_at(std::int64_t stamp_ns) const noexcept {
    if (!attitude_ || std::abs(seconds(stamp_ns - attitude_ns_)) > kMaxAttitudeAge) return std::nullopt;
    return attitude_;
}

}  // namespace fairlead
