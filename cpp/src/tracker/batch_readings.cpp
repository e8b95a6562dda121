// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// What other sensors said, handed to the views of a batch.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "batch.hpp"
#include "fairlead/tracker/range_gate.hpp"
#include "fairlead/tracker/readings.hpp"

namespace fairlead {
namespace {

using Range = BatchReadings::Range;

constexpr double kSpeedShare = 0.1;     // how far a closing speed may be off, one standard deviation
constexpr double kUnknownSpeed = 50.0;  // [m/s] the same where there is none

double seconds(std::int64_t ns) noexcept { return 1e-9 * static_cast<double>(ns); }

/// Believed by the readings before it or by those after it: the first ones have none before them.
std::vector<Range> believed(std::vector<Range> ranges) {
    std::vector<bool> good(ranges.size(), false);
    RangeGate forwards, backwards;
    for (std::size_t i = 0; i < ranges.size(); ++i)
        if (forwards.admit(ranges[i].stamp_ns, ranges[i].range.range_m, ranges[i].range.sigma_m)) good[i] = true;
    for (std::size_t i = ranges.size(); i-- > 0;)
        if (backwards.admit(-ranges[i].stamp_ns, ranges[i].range.range_m, ranges[i].range.sigma_m)) good[i] = true;
    std::vector<Range> kept;
    for (std::size_t i = 0; i < ranges.size(); ++i)
        if (good[i]) kept.push_back(ranges[i]);
    return kept;
}

/// The reading moved to a view's stamp by the closing speed that its neighbours tell, docs/range.md eq. (1).
window::RangeMeasurement moved(std::span<const Range> ranges, std::size_t i, double dt) {
    const Range& before = ranges[i == 0 ? 0 : i - 1];
    const Range& after = ranges[std::min(i + 1, ranges.size() - 1)];
    const double span = seconds(after.stamp_ns - before.stamp_ns);
    const double speed = span > 0.0 ? (after.range.range_m - before.range.range_m) / span : 0.0;
    const double speed_sigma = span > 0.0 ? kSpeedShare * speed : kUnknownSpeed;
    window::RangeMeasurement range = ranges[i].range;
    range.range_m += speed * dt;
    range.sigma_m = std::hypot(range.sigma_m, speed_sigma * dt);
    return range;
}

}  // namespace

std::vector<Candidate*> Batch::in_time() {
    std::vector<Candidate*> sorted;
    sorted.reserve(candidates_.size());
    for (Candidate& candidate : candidates_) sorted.push_back(&candidate);
    std::sort(sorted.begin(), sorted.end(), [](const Candidate* a, const Candidate* b) {
        return std::tie(a->stamp_ns, a) < std::tie(b->stamp_ns, b);
    });
    return sorted;
}

namespace {

/// The view nearest in time, if it is within a limit.
Candidate* nearest(std::span<Candidate* const> views, std::int64_t stamp_ns, double limit_s) {
    Candidate* best = nullptr;
    double least = limit_s;
    const auto later = std::lower_bound(views.begin(), views.end(), stamp_ns,
                                        [](const Candidate* view, std::int64_t t) { return view->stamp_ns < t; });
    for (auto it = later == views.begin() ? later : later - 1; it != views.end() && it <= later; ++it) {
        const double age = std::abs(seconds(stamp_ns - (*it)->stamp_ns));
        if (age > least) continue;
        least = age;
        best = *it;
    }
    return best;
}

}  // namespace

void Batch::add(const BatchReadings& readings) {
    const int n = static_cast<int>(landmarks());
    for (const window::LengthMeasurement& length : readings.lengths) {
        require_length(length, n);
        problem_.lengths.push_back(length);
    }
    std::vector<std::vector<Range>> by_landmark(problem_.X.size());
    for (Range range : readings.ranges) {
        range.range.landmark = range_landmark(range.range.landmark, n, options_);
        require_positive(range.range.range_m, "range_m");
        require_positive(range.range.sigma_m, "sigma_m");
        if (set_aside(options_) > 0) range.range.bias = problem_.landmarks() - 1;
        by_landmark[static_cast<std::size_t>(range.range.landmark)].push_back(range);
    }
    for (std::vector<Range>& ranges : by_landmark) add_ranges(std::move(ranges));
    add_attitudes(readings.attitudes);
}

/// Those to one landmark.
void Batch::add_ranges(std::vector<Range> ranges) {
    std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) {
        return std::tie(a.stamp_ns, a.range.range_m) < std::tie(b.stamp_ns, b.range.range_m);
    });
    const std::vector<Candidate*> views = in_time();
    const std::vector<Range> kept = believed(ranges);
    const int before = believed_;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        Candidate* view = nearest(views, kept[i].stamp_ns, kMaxRangeAge);
        if (view == nullptr) continue;
        view->ranges.push_back(moved(kept, i, seconds(view->stamp_ns - kept[i].stamp_ns)));
        ++believed_;
    }
    refused_ += static_cast<int>(ranges.size()) - (believed_ - before);
}

void Batch::add_attitudes(std::span<const BatchReadings::Attitude> attitudes) {
    const std::vector<Candidate*> views = in_time();
    for (const auto& [stamp_ns, attitude] : attitudes) {
        require_attitude(attitude);
        Candidate* view = nearest(views, stamp_ns, kMaxAttitudeAge);
        if (view != nullptr) view->attitude = attitude;
    }
}

}  // namespace fairlead
