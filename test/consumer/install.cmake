# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D TMINI_SOURCE=… -D BUILD=… -D COMPILER=… -D GENERATOR=… -D PKG_CONFIG=… -P install.cmake
#
# Installs everything into a scratch folder, uses it there (also with pkg-config if installed), and
# uninstalls it: nothing may be left. The library is built as one translation unit, as some
# packagers do. Building it as a shared library must be refused.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

set(prefix ${BUILD}/prefix)

# Fails unless FILE was installed.
function(expect_file file)
    if(NOT EXISTS ${prefix}/${file})
        message(FATAL_ERROR "not installed: ${file}")
    endif()
endfunction()

function(expect_all_files)
    foreach(file lib/libtmini.a lib/libtmini_posix.a include/tmini/tmini_posix.h
            lib/pkgconfig/tmini.pc bin/tmini
            lib/cmake/tmini/tmini-config.cmake lib/cmake/tmini/tmini-config-version.cmake
            share/doc/tmini/LICENSE share/man/man1/tmini.1 share/bash-completion/completions/tmini
            lib/udev/rules.d/60-tmini.rules
            lib/udev/rules.d/95-tmini-brltty.rules)
        expect_file(${file})
    endforeach()
    file(GLOB headers RELATIVE ${TMINI_SOURCE}/lib ${TMINI_SOURCE}/lib/include/tmini/*.h
        ${TMINI_SOURCE}/lib/include/tmini/parts/*.h)
    foreach(header ${headers})
        expect_file(${header})
    endforeach()
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

function(expect_nothing_left)
    file(GLOB_RECURSE left LIST_DIRECTORIES false ${prefix}/*)
    if(left OR EXISTS ${prefix}/include/tmini)
        message(FATAL_ERROR "left behind: ${left} ${prefix}/include/tmini")
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

file(REMOVE_RECURSE ${BUILD})
expect_shared_refused()
install_project(${BUILD}/build ${prefix} ON -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0
    -DTMINI_WERROR=ON)
expect_all_files()
run_or_fail(${prefix}/bin/tmini --help)
if(PKG_CONFIG)
    build_with_pkg_config(${prefix})
    # An installed copy still works after it has been moved.
    file(RENAME ${prefix} ${BUILD}/moved)
    build_with_pkg_config(${BUILD}/moved)
    file(RENAME ${BUILD}/moved ${prefix})
else()
    message("pkg-config is not installed: tmini.pc was not tried")
endif()
run_or_fail(${CMAKE_COMMAND} --build ${BUILD}/build --target uninstall)
expect_nothing_left()
