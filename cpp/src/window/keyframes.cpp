// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/keyframes.hpp"

#include <cmath>
#include <limits>

namespace fairlead::window {

int most_redundant(std::span<const ViewBlock> views, std::span<Eigen::Vector4d> descriptors) noexcept {
    for (std::size_t k = 0; k < views.size(); ++k) {
        const Vec3 centre = camera_centre(views[k].state.T_camera_target);
        descriptors[k] << centre.normalized(), std::log(centre.norm());
    }
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t first = 0;
    std::size_t second = 0;
    for (std::size_t a = 0; a < views.size(); ++a) {
        for (std::size_t b = a + 1; b < views.size(); ++b) {
            const double distance = (descriptors[a] - descriptors[b]).squaredNorm();
            if (distance < nearest) {
                nearest = distance;
                first = a;
                second = b;
            }
        }
    }
    const bool second_says_less = views[second].weights <= views[first].weights;
    return static_cast<int>(second_says_less ? second : first);
}

}  // namespace fairlead::window
