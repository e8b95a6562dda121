// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/shares.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead {
namespace {

constexpr double kSpacing = 0.1;  // correlation lengths between places that stand for the views near them
constexpr double kLeast = 1e-6;   // share: a view without any would have no pose

double inverse(double length) noexcept { return length > 0.0 ? 1.0 / length : 0.0; }

}  // namespace

Outlook outlook(std::int64_t stamp_ns, const SE3& T_camera_target, std::span<const Vec3> X) noexcept {
    Vec3 away = -(T_camera_target.R.transpose() * T_camera_target.t);
    for (const Vec3& x : X) away -= x / static_cast<double>(X.size());
    const double range = std::max(away.norm(), 1e-12);
    return {stamp_ns, away / range, std::log(range)};
}

Shares::Shares(const TrackerOptions& options) noexcept
    : per_second_(inverse(options.correlation_time_s)),
      per_radian_(inverse(options.correlation_angle_rad)),
      per_log_range_(inverse(options.correlation_log_range)),
      white_(per_second_ + per_radian_ + per_log_range_ == 0.0) {}

double Shares::likeness(const Outlook& a, const Outlook& b) const noexcept {
    const double angle = std::atan2(a.direction.cross(b.direction).norm(), a.direction.dot(b.direction));
    const double seconds = 1e-9 * static_cast<double>(a.stamp_ns - b.stamp_ns);
    return std::exp(-per_radian_ * angle - per_log_range_ * std::abs(a.log_range - b.log_range) -
                    per_second_ * std::abs(seconds));
}

/// With g = 1 / range, what a pixel says of a metre, the information sum s g^2 of all views so far has the true
/// variance sum s g rho g s if each new share is 1 - 2 sum rho s g / g_new.
double Shares::of(const Outlook& view) noexcept {
    if (white_) return 1.0;
    newest_ = view;
    most_alike_ = 0.0;
    double known = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
        const double alike = likeness(view, places_[i].outlook);
        known += alike * places_[i].given;
        if (alike <= most_alike_) continue;
        most_alike_ = alike;
        nearest_ = i;
    }
    share_ = std::clamp(1.0 - 2.0 * known * std::exp(view.log_range), kLeast, 1.0);
    return share_;
}

void Shares::take() noexcept {
    if (white_) return;
    const double given = share_ * std::exp(-newest_.log_range);
    if (most_alike_ > std::exp(-kSpacing)) {
        places_[nearest_].given += given / most_alike_;  // as the views ahead will feel it
        return;
    }
    if (n_ == kCapacity) make_room();
    places_[n_++] = {newest_, given};
}

/// Of neighbours in time the two most alike become one.
void Shares::make_room() noexcept {
    std::size_t least = 0;
    double most = -1.0;
    for (std::size_t i = 0; i + 1 < n_; ++i) {
        const double alike = likeness(places_[i].outlook, places_[i + 1].outlook);
        if (alike <= most) continue;
        most = alike;
        least = i;
    }
    places_[least + 1].given += most * places_[least].given;
    std::move(places_.begin() + static_cast<std::ptrdiff_t>(least) + 1,
              places_.begin() + static_cast<std::ptrdiff_t>(n_), places_.begin() + static_cast<std::ptrdiff_t>(least));
    --n_;
}

}  // namespace fairlead
