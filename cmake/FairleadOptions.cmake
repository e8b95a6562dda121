# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
# What every target of this build has in common.

get_property(is_multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(NOT is_multi_config AND NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo" FORCE)
endif()
# Release keeps CMake's -O3: the estimator at -O2 was four times slower.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# Eigen's alignment depends on the instruction set, so that a flag for one is a flag for all: hence no target_compile_options.
if(FAIRLEAD_NATIVE)
    add_compile_options(-march=native)
endif()

if(FAIRLEAD_SANITIZE)
    add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
    add_link_options(-fsanitize=address,undefined)
endif()
if(FAIRLEAD_BUILD_TESTS)
    # Lets a test forbid Eigen's allocations while it calls the core; without effect until it does.
    add_compile_definitions(EIGEN_RUNTIME_NO_MALLOC)
endif()

# Warnings for our own sources; they are errors in continuous integration only.
function(fairlead_warnings target)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow $<$<BOOL:${FAIRLEAD_WERROR}>:-Werror>)
endfunction()
