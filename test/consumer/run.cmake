# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D WAY=… -D TMINI_SOURCE=… -D BUILD=… -D COMPILER=… -D GENERATOR=… [-D PKG_CONFIG=…]
#     -P run.cmake
#
# Configures, checks, builds and runs the consumer project. For FetchContent, TMINI_SOURCE may be
# the archive of a release. For find_package, everything is installed in a scratch folder, used also
# with pkg-config if installed, and uninstalled: nothing may be left. The library is then built as
# one translation unit, as some packagers do. Building it as a shared library must be refused.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)
set(prefix ${BUILD}/prefix)

# Fails if the command line that compiles main.c contains compiler options of ours.
function(check_command_line)
    file(READ ${BUILD}/compile_commands.json commands)
    string(REGEX MATCH "\"command\": \"[^\n]*main\\.c[^\n]*" command "${commands}")
    if(NOT command)
        message(FATAL_ERROR "no command line for main.c in:\n${commands}")
    endif()
    string(REGEX MATCH " -(W|O|f|D|std|pedantic|g)[^ ]*" option "${command}")
    if(option)
        message(FATAL_ERROR "the option${option} has reached the consumer:\n${command}")
    endif()
endfunction()

function(expect_shared_refused)
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${TMINI_SOURCE} -B ${BUILD}/shared -G ${GENERATOR}
        -DCMAKE_C_COMPILER=${COMPILER} -DBUILD_SHARED_LIBS=ON
        RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE text)
    if(status EQUAL 0 OR NOT text MATCHES "static library only")
        message(FATAL_ERROR "BUILD_SHARED_LIBS=ON was not refused in words: ${text}")
    endif()
endfunction()

function(install_everything)
    run_or_fail(${CMAKE_COMMAND} -S ${TMINI_SOURCE} -B ${BUILD}/build -G ${GENERATOR}
        -DCMAKE_C_COMPILER=${COMPILER} -DCMAKE_INSTALL_LIBDIR=lib -DTMINI_BUILD_TESTS=OFF
        -DTMINI_BUILD_EXAMPLES=ON -DTMINI_INSTALL_UDEV_RULE=ON -DCMAKE_UNITY_BUILD=ON
        -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 -DTMINI_WERROR=ON)
    run_or_fail(${CMAKE_COMMAND} --build ${BUILD}/build --parallel 2)
    run_or_fail(${CMAKE_COMMAND} --install ${BUILD}/build --prefix ${prefix})
    file(GLOB headers RELATIVE ${TMINI_SOURCE}/lib ${TMINI_SOURCE}/lib/include/tmini/*.h
        ${TMINI_SOURCE}/lib/include/tmini/parts/*.h)
    foreach(file ${headers} lib/libtmini.a lib/libtmini_posix.a include/tmini/tmini_posix.h
            lib/pkgconfig/tmini.pc bin/tmini lib/cmake/tmini/tmini-config.cmake
            lib/cmake/tmini/tmini-config-version.cmake share/doc/tmini/LICENSE
            share/man/man1/tmini.1 share/bash-completion/completions/tmini
            lib/udev/rules.d/60-tmini.rules lib/udev/rules.d/95-tmini-brltty.rules)
        if(NOT EXISTS ${prefix}/${file})
            message(FATAL_ERROR "not installed: ${file}")
        endif()
    endforeach()
    run_or_fail(${prefix}/bin/tmini --help)
endfunction()

# Compiles a program as a makefile would. The shell removes the quotes in pkg-config's output.
function(build_with_pkg_config from)
    set(ENV{PKG_CONFIG_PATH} ${from}/lib/pkgconfig)
    run_or_fail(sh -c
        "eval '\"\$1\" \"\$2\" -o \"\$3\"' \"$(\"\$4\" --cflags --libs tmini)\""
        sh ${COMPILER} ${CMAKE_CURRENT_LIST_DIR}/main.c ${BUILD}/by_pkg_config ${PKG_CONFIG})
    run_or_fail(${BUILD}/by_pkg_config)
    execute_process(COMMAND ${PKG_CONFIG} --modversion tmini
        OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE)
    file(STRINGS ${TMINI_SOURCE}/CMakeLists.txt project REGEX "^project\\(tmini VERSION")
    if(version STREQUAL "" OR NOT project MATCHES "VERSION ${version}( |$)")
        message(FATAL_ERROR "tmini.pc is of version \"${version}\", but: ${project}")
    endif()
endfunction()

function(uninstall_everything)
    run_or_fail(${CMAKE_COMMAND} --build ${BUILD}/build --target uninstall)
    file(GLOB_RECURSE left LIST_DIRECTORIES false ${prefix}/*)
    if(left OR EXISTS ${prefix}/include/tmini)
        message(FATAL_ERROR "left behind: ${left} ${prefix}/include/tmini")
    endif()
endfunction()

file(REMOVE_RECURSE ${BUILD})
if(WAY STREQUAL "find_package")
    expect_shared_refused()
    install_everything()
endif()
set(fetched ${TMINI_SOURCE})
if(NOT IS_DIRECTORY ${TMINI_SOURCE})
    set(fetched "")
endif()
run_or_fail(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${BUILD} -G ${GENERATOR}
    -DCMAKE_C_COMPILER=${COMPILER} -DWAY=${WAY} -DTMINI_SOURCE=${TMINI_SOURCE}
    -DFETCHCONTENT_SOURCE_DIR_TMINI=${fetched} -DCMAKE_PREFIX_PATH=${prefix})
check_command_line()
run_or_fail(${CMAKE_COMMAND} --build ${BUILD})

# The program is where the consumer expects it, not in an output folder of ours.
run_or_fail(${BUILD}/consumer)
if(WAY STREQUAL "find_package")
    if(UNIX)
        run_or_fail(${BUILD}/with_port)
    endif()
    if(PKG_CONFIG)
        build_with_pkg_config(${prefix})
        # An installed copy still works after it has been moved.
        file(RENAME ${prefix} ${BUILD}/moved)
        build_with_pkg_config(${BUILD}/moved)
        file(RENAME ${BUILD}/moved ${prefix})
    else()
        message("pkg-config is not installed: tmini.pc was not tried")
    endif()
    uninstall_everything()
endif()
