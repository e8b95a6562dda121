// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "fairlead/geometry/types.hpp"
#include "fairlead/motion/white_jerk.hpp"

namespace fairlead::motion {

/// How rough the path really is: Kalman filters with densities from a hundredth to ten thousand times what was told
/// follow the positions that single views give, and their recent likelihoods weigh the densities, docs/motion.md eq.
/// (10)-(11).
class DensityBank {
  public:
    DensityBank(double told, int axes);

    void restart() noexcept {
        started_ = false;
        density_ = told_;
    }
    /// A view's own position [m] with its covariance, dt after the last.
    void observe(double dt, const Vec3& position, const Mat33& covariance) noexcept;
    [[nodiscard]] double density() const noexcept { return density_; }

  private:
    static constexpr int kFilters = 7;
    struct Filter {
        double density = 0.0;
        double log_likelihood = 0.0, recent = 0.0;  ///< over the long and over the short memory
        State mean;
        StateSquare covariance;
    };
    [[nodiscard]] double mean(double Filter::* log_likelihood) const noexcept;
    void start(const Vec3& position, const Mat33& covariance) noexcept;

    int axes_;
    double told_, density_;
    bool started_ = false;
    std::array<Filter, kFilters> filters_;
};

}  // namespace fairlead::motion
