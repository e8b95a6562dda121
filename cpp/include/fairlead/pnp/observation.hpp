// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/geometry/camera.hpp"
#include "fairlead/geometry/se3.hpp"

namespace fairlead {

/// One landmark seen in one image: pixel and its 2x2 covariance [px^2].
struct Observation {
    int landmark = -1;  ///< index into the landmark model
    Vec2 z = Vec2::Zero();
    Mat22 covariance = Mat22::Identity();
};

}  // namespace fairlead
