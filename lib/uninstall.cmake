# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D BUILD=build folder -P uninstall.cmake
#
# Removes what was last installed from that build folder, and our own folders if they are empty
# then. DESTDIR has the same effect as when installing.

set(manifest ${BUILD}/install_manifest.txt)
if(NOT EXISTS ${manifest})
    message(FATAL_ERROR "Nothing has been installed from ${BUILD}, which has no\n${manifest}")
endif()

file(STRINGS ${manifest} files ENCODING UTF-8)
foreach(file ${files})
    set(file "$ENV{DESTDIR}${file}")
    if(EXISTS "${file}" OR IS_SYMLINK "${file}")
        message("-- Removing: ${file}")
        file(REMOVE "${file}")
    else()
        message("-- Not there: ${file}")
    endif()
    # Our folders are tmini and tmini/parts.
    get_filename_component(folder "${file}" DIRECTORY)
    file(GLOB rest "${folder}/*")
    while(folder MATCHES "/tmini(/parts)?$" AND NOT rest)
        file(REMOVE_RECURSE "${folder}")
        get_filename_component(folder "${folder}" DIRECTORY)
        file(GLOB rest "${folder}/*")
    endwhile()
endforeach()
