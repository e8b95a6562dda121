// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/range_gate.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead {
namespace {

constexpr double kGate = 16.0;         // squared innovation [sigma^2] that is still believed
constexpr double kAcceleration = 3.0;  // [m/s^2] of the range that an aircraft may have, one standard deviation
constexpr double kMaxSpan = 15.0;      // [s] within which readings are compared
constexpr int kRefusals = 3;
constexpr int kOnLine = 4;  // readings that start the filter

}  // namespace

/// Looks for earlier readings that lie on a line with this one, the bend of an acceleration allowed; the filter then
/// starts on that line. Three are not enough: two wrong ones to either side of a good one are a line as well.
bool RangeGate::start(const Reading& c) noexcept {
    bool found = false;
    for (int i = 0; i < filled_ && !found; ++i) {
        const Reading& a = recent_[static_cast<std::size_t>(i)];
        const double span = 1e-9 * static_cast<double>(c.stamp_ns - a.stamp_ns);
        if (!(span > 0.0 && span < kMaxSpan)) continue;
        const double speed = (c.range_m - a.range_m) / span;
        int on_line = 2;
        double sigma = std::max(a.sigma_m, c.sigma_m);
        for (int j = i + 1; j < filled_; ++j) {
            const Reading& b = recent_[static_cast<std::size_t>(j)];
            const double part = 1e-9 * static_cast<double>(b.stamp_ns - a.stamp_ns);
            if (!(part > 0.0 && part < span)) continue;
            const double bend = 0.5 * kAcceleration * part * (span - part);
            const double largest = std::max(sigma, b.sigma_m);
            if (std::abs(a.range_m + speed * part - b.range_m) > std::sqrt(kGate * 2.0) * largest + bend) continue;
            sigma = largest;
            ++on_line;
        }
        if (on_line < kOnLine) continue;
        mean_ = {c.range_m, speed};
        const double speed_sigma = 2.0 * sigma / span + 0.5 * kAcceleration * span;
        covariance_ << c.sigma_m * c.sigma_m, 0.0, 0.0, speed_sigma * speed_sigma;
        stamp_ns_ = c.stamp_ns;
        found = true;
    }
    if (filled_ == static_cast<int>(recent_.size())) {
        std::rotate(recent_.begin(), recent_.begin() + 1, recent_.end());
        --filled_;
    }
    recent_[static_cast<std::size_t>(filled_++)] = c;
    return found;
}

bool RangeGate::admit(std::int64_t stamp_ns, double range_m, double sigma_m) noexcept {
    if (!started_) {
        started_ = start({stamp_ns, range_m, sigma_m});
        refused_ = 0;
        return started_;
    }
    const double dt = 1e-9 * static_cast<double>(stamp_ns - stamp_ns_);
    if (!(dt >= 0.0)) return false;
    Mat22 Phi;
    Phi << 1.0, dt, 0.0, 1.0;
    Mat22 Q;
    Q << dt * dt * dt / 3.0, dt * dt / 2.0, dt * dt / 2.0, dt;
    const Vec2 mean = Phi * mean_;
    const Mat22 P = Phi * covariance_ * Phi.transpose() + kAcceleration * kAcceleration * Q;
    const double S = P(0, 0) + sigma_m * sigma_m;
    const double innovation = range_m - mean[0];
    if (innovation * innovation > kGate * S) {
        if (++refused_ >= kRefusals) {
            started_ = false;
            filled_ = 0;
        }
        return false;
    }
    const Vec2 gain = P.col(0) / S;
    mean_ = mean + gain * innovation;
    covariance_ = P - gain * S * gain.transpose();
    stamp_ns_ = stamp_ns;
    refused_ = 0;
    return true;
}

}  // namespace fairlead
