// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/keyframes.hpp"

#include <cmath>

namespace fairlead::window {

Eigen::Vector4d descriptor(const ViewBlock& view) noexcept {
    const Vec3 centre = camera_centre(view.state.T_camera_target);
    Eigen::Vector4d d;
    d << centre.normalized(), std::log(centre.norm());
    return d;
}

Pair closest_pair(std::span<const ViewBlock> views, std::span<Eigen::Vector4d> descriptors) noexcept {
    for (std::size_t k = 0; k < views.size(); ++k) descriptors[k] = descriptor(views[k]);
    Pair nearest;
    for (std::size_t a = 0; a < views.size(); ++a) {
        for (std::size_t b = a + 1; b < views.size(); ++b) {
            const double distance = (descriptors[a] - descriptors[b]).squaredNorm();
            if (distance < nearest.distance_squared) nearest = {a, b, distance};
        }
    }
    return nearest;
}

int most_redundant(std::span<const ViewBlock> views, std::span<Eigen::Vector4d> descriptors) noexcept {
    const auto [first, second, distance] = closest_pair(views, descriptors);
    const bool second_says_less = views[second].inliers <= views[first].inliers;
    return static_cast<int>(second_says_less ? second : first);
}

}  // namespace fairlead::window
