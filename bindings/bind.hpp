// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>

namespace fairlead::bindings {

void bind_geometry(nanobind::module_& m);  ///< Camera, projection
void bind_pnp(nanobind::module_& m);       ///< minimal and refined poses
void bind_study(nanobind::module_& m);     ///< many flights, many methods, in threads
void bind_tracker(nanobind::module_& m);   ///< Tracker, refine, solve_window

}  // namespace fairlead::bindings
