// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/shares.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead {
namespace {

constexpr double kSpacing = 0.25;   // correlation lengths between views that stand for all
constexpr double kLeast = 1e-6;     // share: a view without any would have no pose
constexpr double kSingular = 1e-9;  // variance of a view, given the others, that is none

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

double Shares::of(const Outlook& view) noexcept {
    if (white_) return 1.0;
    newest_ = view;
    most_alike_ = 0.0;
    for (int i = 0; i < n_; ++i) {
        row_[i] = likeness(view, anchors_[static_cast<std::size_t>(i)]);
        most_alike_ = std::max(most_alike_, row_[i]);
    }
    L_.topLeftCorner(n_, n_).triangularView<Eigen::Lower>().solveInPlace(row_.head(n_));
    rest_ = 1.0 - row_.head(n_).squaredNorm();
    const double more = 1.0 - row_.head(n_).dot(z_.head(n_));
    news_ = rest_ > kSingular ? more * more / rest_ : 0.0;
    return std::max(kLeast, news_ - advance_);
}

void Shares::take() noexcept {
    if (white_) return;
    const bool stands_for_others = most_alike_ < std::exp(-kSpacing);
    advance_ = std::max(advance_, news_);
    if (!stands_for_others) return;
    advance_ -= news_;
    if (n_ == kCapacity) make_room();
    append();
}

/// One more row of the factor.
void Shares::append() noexcept {
    const double diagonal = std::sqrt(std::max(rest_, kSingular));
    L_.row(n_).head(n_) = row_.head(n_).transpose();
    L_(n_, n_) = diagonal;
    z_[n_] = (1.0 - row_.head(n_).dot(z_.head(n_))) / diagonal;
    anchors_[static_cast<std::size_t>(n_++)] = newest_;
}

/// The older of the two views that are most alike is forgotten, and the newest judged against the others.
void Shares::make_room() noexcept {
    int forgotten = 0;
    double most = -1.0;
    for (int i = 0; i < n_; ++i) {
        const Outlook& a = anchors_[static_cast<std::size_t>(i)];
        for (int j = i + 1; j <= n_; ++j) {
            const double alike = likeness(a, j < n_ ? anchors_[static_cast<std::size_t>(j)] : newest_);
            if (alike <= most) continue;
            most = alike;
            forgotten = i;
        }
    }
    const Outlook newest = newest_;
    const int kept = n_;
    n_ = 0;
    for (int i = 0; i < kept; ++i) {
        if (i == forgotten) continue;
        (void)of(anchors_[static_cast<std::size_t>(i)]);
        append();
    }
    (void)of(newest);
}

}  // namespace fairlead
