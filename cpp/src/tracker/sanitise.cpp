// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/tracker/sanitise.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead {
namespace {

bool usable(const Observation& o, int landmarks) noexcept {
    const Mat22& S = o.covariance;
    if (o.landmark < 0 || o.landmark >= landmarks || !o.z.allFinite() || !S.allFinite()) return false;
    if (std::abs(S(0, 1) - S(1, 0)) > 1e-9 * (std::abs(S(0, 1)) + S(0, 0))) return false;
    const double determinant = S.determinant();
    return S(0, 0) > 0.0 && S(1, 1) > 0.0 && determinant > 1e-12 * S(0, 0) * S(1, 1) &&
           std::isfinite(1.0 / determinant);
}

}  // namespace

int sanitise(std::span<const Observation> observations, int landmarks, std::vector<Observation>& out) noexcept {
    out.clear();
    for (const Observation& o : observations) {
        if (!usable(o, landmarks)) continue;
        const auto twin =
            std::find_if(out.begin(), out.end(), [&](const Observation& p) { return p.landmark == o.landmark; });
        if (twin == out.end())
            out.push_back(o);
        else if (o.covariance.determinant() < twin->covariance.determinant())
            *twin = o;
    }
    return static_cast<int>(observations.size() - out.size());
}

}  // namespace fairlead
