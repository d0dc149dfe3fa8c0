# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Checks the library as one file: with only its archive, it compiles without warnings with every
# installed compiler; and in place of the library it passes the tests that use all of it.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

# strict(COMPILER FLAG…): compiles with warnings as errors, if the compiler is installed.
function(strict compiler)
    find_program(${compiler} ${compiler})
    if(${compiler})
        message("${compiler}")
        run_or_fail(${${compiler}} -pedantic -Wall -Wextra -Wconversion -Wshadow -Wundef -Werror
            -ffreestanding -c -o ${WORK}/out.o ${ARGN})
    endif()
endfunction()

unpack(-single.zip)
set(all -std=c99 ${WORK}/tmini_all.c)
strict(gcc ${all})
strict(clang ${all})
strict(arm-none-eabi-gcc -mcpu=cortex-m0 -mthumb -Os ${all})
strict(avr-gcc -mmcu=atmega2560 -Os ${all})
file(GLOB headers RELATIVE ${WORK} ${WORK}/tmini/*.h ${WORK}/tmini/parts/*.h)
set(includes "int main();\n")
foreach(header ${headers})
    string(APPEND includes "#include \"${header}\"\n")
endforeach()
file(WRITE ${WORK}/headers.cpp "${includes}")
strict(g++ -std=c++11 ${WORK}/headers.cpp)

configure(${ROOT} -DTMINI_BUILD_TESTS=ON -DTMINI_BUILD_EXAMPLES=OFF -DTMINI_INSTALL=OFF
    -DTMINI_SINGLE=${WORK}
    -DCMAKE_PROJECT_tmini_INCLUDE=${CMAKE_CURRENT_LIST_DIR}/instead.cmake)
test_driver_and_decoder()
