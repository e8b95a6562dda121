// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fairlead/window/state.hpp"

namespace fairlead::window {

/// The view that the window can spare: one of the two most alike, the one with less information (the newer if equal).
/// Likeness of two views is the distance of their descriptors (unit viewing direction in the target frame, logarithm of
/// the range), docs/estimator.md eq. (13). descriptors is scratch, one per view.
[[nodiscard]] int most_redundant(std::span<const ViewBlock> views, std::span<Eigen::Vector4d> descriptors) noexcept;

}  // namespace fairlead::window
