# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D EXAMPLE=folder -D MAP=firmware.map -P readme_sizes.cmake
#
# Fails if a size in the example's README differs from the firmware's by more than 10 %.

include(${EXAMPLE}/sizes.cmake)
file(READ ${EXAMPLE}/README.md readme)

function(compare what claimed actual)
    math(EXPR difference "10 * (${claimed} - ${actual})")
    if(difference GREATER actual OR difference LESS -${actual})
        message(SEND_ERROR "README.md says ${what} ${claimed}, but it is ${actual}")
    endif()
endfunction()

if(NOT readme MATCHES "flash ([0-9]+) bytes, of them the library ([0-9]+)")
    message(FATAL_ERROR "README.md does not say what the firmware takes of flash")
endif()
compare("flash" ${CMAKE_MATCH_1} ${flash})
compare("flash of the library" ${CMAKE_MATCH_2} ${library_flash})
if(NOT readme MATCHES "RAM ([0-9]+) bytes, of them stack ([0-9]+)")
    message(FATAL_ERROR "README.md does not say what the firmware takes of RAM")
endif()
compare("RAM" ${CMAKE_MATCH_1} ${ram})
compare("stack" ${CMAKE_MATCH_2} ${stack})
