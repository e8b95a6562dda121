# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
# Installs headers, libraries and what find_package(fairlead) reads: the component `development`. The wheel takes `python` alone.

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

get_property(fairlead_targets GLOBAL PROPERTY FAIRLEAD_TARGETS)
install(TARGETS ${fairlead_targets} EXPORT fairleadTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
        COMPONENT development)
install(DIRECTORY cpp/include/fairlead DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development)
set(fairlead_config_dir "${CMAKE_INSTALL_LIBDIR}/cmake/fairlead")
install(EXPORT fairleadTargets NAMESPACE fairlead:: DESTINATION "${fairlead_config_dir}" COMPONENT development)
configure_package_config_file(
    cmake/fairleadConfig.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/fairleadConfig.cmake" INSTALL_DESTINATION "${fairlead_config_dir}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/fairleadConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/fairleadConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/fairleadConfigVersion.cmake"
        DESTINATION "${fairlead_config_dir}" COMPONENT development)
