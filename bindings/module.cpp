// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// The private module fairlead._core. Each bindings/<part>.cpp defines one bind_<part>; this file only calls them.
#include <nanobind/nanobind.h>

#include "bind.hpp"

namespace nb = nanobind;

NB_MODULE(_core, module) {
    nb::set_leak_warnings(false);  // what Python still holds at exit is no error, and a library prints nothing
    module.doc() = "The C++ core of fairlead. Private: use the typed wrappers of the package.";
    module.attr("__version__") = FAIRLEAD_VERSION;
    fairlead::bindings::bind_geometry(module);
    fairlead::bindings::bind_pnp(module);
    fairlead::bindings::bind_tracker(module);
    fairlead::bindings::bind_study(module);
}
