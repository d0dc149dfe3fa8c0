# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Install rules, so that find_package(tmini) finds an installed copy.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tmini)

install(TARGETS tmini EXPORT tmini ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/tmini DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

# Without dependencies the exported targets are all the package's configuration.
install(EXPORT tmini NAMESPACE tmini:: FILE tmini-config.cmake DESTINATION ${package_dir})

write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/tmini-config-version.cmake
    VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/tmini-config-version.cmake DESTINATION ${package_dir})
