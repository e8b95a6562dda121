# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0

# fairlead_library(NAME [LINKS targets...] [SOURCES globs...]): one target per folder of cpp/src. What a folder may use is what
# its line in cpp/CMakeLists.txt links; tests/house checks that its includes say the same.
function(fairlead_library name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LINKS;SOURCES")
    if(NOT arg_SOURCES)
        set(arg_SOURCES "src/${name}/*.cpp")
    endif()
    file(GLOB sources CONFIGURE_DEPENDS ${arg_SOURCES})
    set(target fairlead_${name})
    add_library(${target} STATIC ${sources})
    add_library(fairlead::${name} ALIAS ${target})
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(
        ${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
    target_link_libraries(${target} PUBLIC Eigen3::Eigen ${arg_LINKS})
    # Eigen packs operands on the stack up to this size, so that models of up to 110 landmarks never touch the heap.
    target_compile_definitions(${target} PRIVATE EIGEN_STACK_ALLOCATION_LIMIT=1048576)
    fairlead_warnings(${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
    set_property(GLOBAL APPEND PROPERTY FAIRLEAD_TARGETS ${target})
endfunction()
