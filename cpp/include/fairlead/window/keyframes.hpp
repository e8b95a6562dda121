// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "fairlead/window/state.hpp"

namespace fairlead::window {

/// Where a view looks from: unit viewing direction in the target frame, logarithm of the range, docs/estimator.md eq.
/// (13).
[[nodiscard]] Eigen::Vector4d descriptor(const ViewBlock& view) noexcept;

struct Pair {
    std::size_t first = 0, second = 0;
    double distance_squared = std::numeric_limits<double>::infinity();
};

/// The two views most alike; descriptors is scratch, one per view.
[[nodiscard]] Pair closest_pair(std::span<const ViewBlock> views, std::span<Eigen::Vector4d> descriptors) noexcept;

/// The view that the window can spare: one of the two most alike, the one with less information (the newer if equal).
[[nodiscard]] int most_redundant(std::span<const ViewBlock> views, std::span<Eigen::Vector4d> descriptors) noexcept;

}  // namespace fairlead::window
