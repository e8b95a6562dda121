// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "fairlead/tracker/estimate.hpp"
#include "fairlead/tracker/start_pose.hpp"

namespace fairlead {

/// Where the target may be while no view fixes its pose: the last pose, with a covariance that grows as the pose has
/// been seen to move,
///   Sigma(t) = Sigma_last + E[v v^T] (t - t_last)^2,  v the pose's mean rate over intervals of at least half a second,
/// docs/estimator.md eq. (20); and, for those who want to look there, that pose carried on at the last of these rates.
class Coast {
  public:
    void restart(std::int64_t stamp_ns, const SE3& T, const Mat66& covariance) noexcept;
    void observe(std::int64_t stamp_ns, const SE3& T, const Mat66& covariance) noexcept;

    [[nodiscard]] double age_s(std::int64_t stamp_ns) const noexcept {
        return 1e-9 * static_cast<double>(stamp_ns - stamp_ns_);
    }
    /// d range / dt [m/s] as last seen over half a second.
    [[nodiscard]] double range_rate() const noexcept { return range_rate_; }
    [[nodiscard]] const SE3& pose() const noexcept { return T_; }
    /// T Exp(v (t - t_last)) at the estimate's stamp, if that is not before the last pose or more than limit_s after
    /// it.
    [[nodiscard]] Estimate predict(Estimate estimate, double limit_s) const noexcept;
    [[nodiscard]] Mat66 covariance(std::int64_t stamp_ns) const noexcept;

  private:
    std::int64_t stamp_ns_ = 0;
    SE3 T_;
    Mat66 covariance_ = Mat66::Identity();
    std::int64_t reference_ns_ = 0;
    SE3 reference_;
    double range_rate_ = 0.0;
    Vec6 velocity_ = Vec6::Zero();    ///< v [m/s, rad/s]
    Mat66 rate_ = Mat66::Identity();  ///< E[v v^T]
};

/// A pose with prior N(T, covariance) updated by a view too poor to fix it: iterated Gauss-Newton on inflated
/// observations.
void update_pose(const Camera& camera, const UncertainModel& model, std::span<const Observation> inflated, SE3& T,
                 Mat66& covariance) noexcept;

}  // namespace fairlead
