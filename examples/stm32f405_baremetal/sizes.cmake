# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D MAP=firmware.map -P sizes.cmake
#
# Prints, from the linker's map, how much flash and RAM the firmware needs, and how much of that is
# the library's.

file(STRINGS ${MAP} lines)

# Section names of more than 15 characters are on a separate line.
set(section "")
set(output "")
foreach(name flash ram library_flash library_ram stack)
    set(${name} 0)
endforeach()

foreach(line IN LISTS lines)
    if(line MATCHES "^(\\.[a-zA-Z._]+)( |$)")
        set(output ${CMAKE_MATCH_1})
    endif()
    set(sections "text|ARM\\.extab|ARM\\.exidx|stack|data|bss")
    if(line MATCHES "^(\\.(${sections})) +0x[0-9a-f]+ +(0x[0-9a-f]+)")
        math(EXPR size "${CMAKE_MATCH_3}")
        if(output STREQUAL ".stack")
            set(stack ${size})
        endif()
        if(output MATCHES "text|extab|exidx|data")
            math(EXPR flash "${flash} + ${size}")
        endif()
        if(output MATCHES "data|bss|stack")
            math(EXPR ram "${ram} + ${size}")
        endif()
    elseif(line MATCHES "0x[0-9a-f]+ +(0x[0-9a-f]+) .*libtmini\\.a")
        math(EXPR size "${CMAKE_MATCH_1}")
        if(output MATCHES "text|extab|exidx|data")
            math(EXPR library_flash "${library_flash} + ${size}")
        endif()
        if(output MATCHES "data|bss")
            math(EXPR library_ram "${library_ram} + ${size}")
        endif()
    endif()
endforeach()

message("flash ${flash} bytes, of them the library ${library_flash}")
message("RAM ${ram} bytes, of them stack ${stack}, static data of the library ${library_ram}")
