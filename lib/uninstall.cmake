# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D BUILD=build folder -P uninstall.cmake
#
# Removes what was last installed from that folder, and what folders of ours it leaves empty.
# DESTDIR is heeded, as it was when installing.

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
    # Ours are tmini, and parts in it.
    get_filename_component(folder "${file}" DIRECTORY)
    file(GLOB rest "${folder}/*")
    while(folder MATCHES "/tmini(/parts)?$" AND NOT rest)
        file(REMOVE_RECURSE "${folder}")
        get_filename_component(folder "${folder}" DIRECTORY)
        file(GLOB rest "${folder}/*")
    endwhile()
endforeach()
