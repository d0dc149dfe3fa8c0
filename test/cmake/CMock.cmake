# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Finds Unity and CMock, and makes the libraries `tmini_unity` and `tmini_cmock` from their sources,
# so that they fit whatever machine the tests are built for. In this order:
#   1. -DCMOCK_ROOT=DIR, or the environment variable CMOCK_ROOT: a copy of CMock with its submodule
#      vendor/unity;
#   2. the package `cmock` of Debian (trixie and later) and Ubuntu (24.04 and later);
#   3. a download, pinned by commit: a git commit is the hash of all that it contains.
# Sets TMINI_CMOCK_DIR, TMINI_UNITY_DIR, TMINI_RUBY.

set(CMOCK_ROOT "$ENV{CMOCK_ROOT}" CACHE PATH "Folder of CMock, with Unity in vendor/unity")

function(tmini_run_git out)
    execute_process(COMMAND ${GIT_EXECUTABLE} ${ARGN} RESULT_VARIABLE status
        OUTPUT_QUIET ERROR_QUIET)
    set(${out} ${status} PARENT_SCOPE)
endfunction()

# Sets OUT to the folder of a downloaded copy, or to nothing.
function(tmini_download_cmock out)
    # Release v2.6.0; its submodule is Unity v2.6.1.
    set(commit 49435d9f3313abb3422252d3d2dc12a7542332ca)
    set(dir ${CMAKE_BINARY_DIR}/cmock-${commit})
    set(${out} ${dir} PARENT_SCOPE)
    if(EXISTS ${dir}/complete)
        return()
    endif()
    message(STATUS "CMock is not installed: downloading it (choose a copy with -DCMOCK_ROOT=DIR)")
    find_package(Git QUIET)
    set(status "no git")
    if(GIT_FOUND)
        file(REMOVE_RECURSE ${dir})
        tmini_run_git(status clone --quiet https://github.com/ThrowTheSwitch/CMock.git ${dir})
    endif()
    foreach(step "checkout;--quiet;${commit}" "submodule;update;--quiet;--init;vendor/unity")
        if(status EQUAL 0)
            tmini_run_git(status -C ${dir} ${step})
        endif()
    endforeach()
    if(status EQUAL 0)
        file(WRITE ${dir}/complete "")
    else()
        set(${out} "" PARENT_SCOPE)
    endif()
endfunction()

find_program(TMINI_RUBY ruby)
if(NOT TMINI_RUBY)
    message(FATAL_ERROR "The tests need Ruby, for the generators of Unity and CMock. test/run.sh "
        "installs what they need.")
endif()

if(CMOCK_ROOT)
    # A folder that was asked for is used or refused, never silently replaced by another.
    get_filename_component(TMINI_CMOCK_DIR ${CMOCK_ROOT} ABSOLUTE BASE_DIR ${CMAKE_BINARY_DIR})
elseif(EXISTS /usr/share/cmock/lib/cmock.rb)
    set(TMINI_CMOCK_DIR /usr/share/cmock)
else()
    tmini_download_cmock(TMINI_CMOCK_DIR)
    if(NOT TMINI_CMOCK_DIR)
        message(FATAL_ERROR "The tests need CMock, which is neither installed nor to be "
            "downloaded. test/run.sh installs what they need; -DCMOCK_ROOT=DIR names a copy.")
    endif()
endif()
set(TMINI_UNITY_DIR ${TMINI_CMOCK_DIR}/vendor/unity)

foreach(file ${TMINI_CMOCK_DIR}/lib/cmock.rb ${TMINI_UNITY_DIR}/auto/generate_test_runner.rb)
    if(NOT EXISTS ${file})
        message(FATAL_ERROR "${file} is missing: ${TMINI_CMOCK_DIR} is not a complete CMock.")
    endif()
endforeach()

# Code of others: no warnings from it, and none from its headers in our tests.
add_library(tmini_unity STATIC EXCLUDE_FROM_ALL ${TMINI_UNITY_DIR}/src/unity.c)
target_include_directories(tmini_unity SYSTEM PUBLIC ${TMINI_UNITY_DIR}/src)
target_include_directories(tmini_unity PUBLIC ${CMAKE_CURRENT_LIST_DIR}/../support)
target_compile_definitions(tmini_unity PUBLIC UNITY_INCLUDE_CONFIG_H)
target_compile_options(tmini_unity PRIVATE -w)

add_library(tmini_cmock STATIC EXCLUDE_FROM_ALL ${TMINI_CMOCK_DIR}/src/cmock.c)
target_include_directories(tmini_cmock SYSTEM PUBLIC ${TMINI_CMOCK_DIR}/src)
target_link_libraries(tmini_cmock PUBLIC tmini_unity)
target_compile_options(tmini_cmock PRIVATE -w)

if(TMINI_TEST_BOARD_SOURCES)
    target_sources(tmini_unity PRIVATE ${TMINI_TEST_BOARD_SOURCES})
endif()
