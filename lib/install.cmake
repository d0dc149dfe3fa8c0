# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Install rules, so that find_package(tmini) and pkg-config find an installed copy; and the target
# `uninstall`, which removes it.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tmini)

install(TARGETS tmini EXPORT tmini ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/tmini DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The package has no dependencies, so the exported targets are its whole configuration.
install(EXPORT tmini NAMESPACE tmini:: FILE tmini-config.cmake DESTINATION ${package_dir})

write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/tmini-config-version.cmake
    VERSION ${PROJECT_VERSION} COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/tmini-config-version.cmake DESTINATION ${package_dir})

# Sets OUT to a folder as tmini.pc names it: below the prefix, unless it was given as an absolute
# path.
function(tmini_name_for_pkgconfig out folder)
    if(IS_ABSOLUTE ${folder})
        set(${out} ${folder} PARENT_SCOPE)
    else()
        set(${out} "\${prefix}/${folder}" PARENT_SCOPE)
    endif()
endfunction()

file(RELATIVE_PATH pc_to_prefix ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
tmini_name_for_pkgconfig(pc_include ${CMAKE_INSTALL_INCLUDEDIR})
tmini_name_for_pkgconfig(pc_lib ${CMAKE_INSTALL_LIBDIR})
configure_file(tmini.pc.in ${CMAKE_CURRENT_BINARY_DIR}/tmini.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/tmini.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

add_custom_target(uninstall
    COMMAND ${CMAKE_COMMAND} -D BUILD=${PROJECT_BINARY_DIR}
        -P ${CMAKE_CURRENT_SOURCE_DIR}/uninstall.cmake
    VERBATIM)
