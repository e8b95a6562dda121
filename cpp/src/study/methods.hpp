// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/pnp/refine.hpp"
#include "fairlead/study.hpp"

namespace fairlead::study {

/// No pose of any view, no covariance of the model, the told landmarks.
[[nodiscard]] Answer no_answer(const Flight& flight);

/// Pose and covariance, the inverse information, of view k; left NaN unless the pose is usable.
void put(const pnp::RefineResult& pose, std::size_t k, Answer& answer);

[[nodiscard]] Answer start(const Camera& camera, const Flight& flight);
[[nodiscard]] Answer single_view(const Camera& camera, const Flight& flight);
[[nodiscard]] Answer true_model(const Camera& camera, const Flight& flight, double loss_threshold);
[[nodiscard]] Answer free_window(const Camera& camera, const Flight& flight, const FreeWindowOptions& options);
[[nodiscard]] Answer map(const Camera& camera, const Flight& flight, const TrackerOptions& options);
[[nodiscard]] Answer online(const Camera& camera, const Flight& flight, const TrackerOptions& options);
[[nodiscard]] Answer bound(const Camera& camera, const Flight& flight);

}  // namespace fairlead::study
