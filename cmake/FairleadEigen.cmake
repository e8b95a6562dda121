# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
# Eigen 3.4 or newer: the system's, one on CMAKE_PREFIX_PATH, or, for the Python module, the one that the package cmeel-eigen holds.

if(FAIRLEAD_BUILD_PYTHON)
    find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module)
    execute_process(
        COMMAND "${Python_EXECUTABLE}" -c
                "import importlib.util as u, pathlib; s = u.find_spec('cmeel'); \
print(pathlib.Path(s.submodule_search_locations[0]).parent / 'cmeel.prefix' if s else '')"
        OUTPUT_VARIABLE fairlead_cmeel_prefix OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
find_package(Eigen3 CONFIG REQUIRED HINTS ${fairlead_cmeel_prefix})
if(Eigen3_VERSION VERSION_LESS 3.4)
    message(FATAL_ERROR "fairlead needs Eigen 3.4 or newer; ${Eigen3_DIR} has ${Eigen3_VERSION}")
endif()
