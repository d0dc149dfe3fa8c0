# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Finds Unity and CMock and builds the libraries `tmini_unity` and `tmini_cmock` from their sources,
# because the tests are built for several machines. Places searched, in this order:
#   1. -DCMOCK_ROOT=DIR, or the environment variable CMOCK_ROOT: a copy of CMock with its submodule
#      vendor/unity;
#   2. the package `cmock` of Debian (trixie and later) and Ubuntu (24.04 and later);
#   3. a download, pinned by commit: a git commit is the hash of its whole content.
# Sets TMINI_CMOCK_DIR, TMINI_UNITY_DIR, TMINI_RUBY.

set(CMOCK_ROOT "$ENV{CMOCK_ROOT}" CACHE PATH "Folder of CMock, with Unity in vendor/unity")

# Downloads CMock with Unity, once, and sets OUT to its folder.
function(tmini_download_cmock out)
    message(STATUS "CMock is not installed: using a download (test/run.sh installs it; "
        "-DCMOCK_ROOT=DIR names a copy)")
    include(FetchContent)
    # Release v2.6.0; its submodule is Unity v2.6.1.
    FetchContent_Declare(cmock GIT_REPOSITORY https://github.com/ThrowTheSwitch/CMock.git
        GIT_TAG 49435d9f3313abb3422252d3d2dc12a7542332ca GIT_SUBMODULES vendor/unity
        SOURCE_SUBDIR lib) # Its own CMakeLists.txt is not wanted.
    FetchContent_MakeAvailable(cmock)
    set(${out} ${cmock_SOURCE_DIR} PARENT_SCOPE)
endfunction()

find_program(TMINI_RUBY ruby)
if(NOT TMINI_RUBY)
    message(FATAL_ERROR "The tests need Ruby, for the generators of Unity and CMock. test/run.sh "
        "installs what they need.")
endif()

if(CMOCK_ROOT)
    # If the folder that the user named is unusable, no other is searched: the error is reported.
    get_filename_component(TMINI_CMOCK_DIR ${CMOCK_ROOT} ABSOLUTE BASE_DIR ${CMAKE_BINARY_DIR})
elseif(EXISTS /usr/share/cmock/lib/cmock.rb)
    set(TMINI_CMOCK_DIR /usr/share/cmock)
else()
    tmini_download_cmock(TMINI_CMOCK_DIR)
endif()
set(TMINI_UNITY_DIR ${TMINI_CMOCK_DIR}/vendor/unity)

foreach(file ${TMINI_CMOCK_DIR}/lib/cmock.rb ${TMINI_UNITY_DIR}/auto/generate_test_runner.rb)
    if(NOT EXISTS ${file})
        message(FATAL_ERROR "${file} is missing: ${TMINI_CMOCK_DIR} is not a complete CMock.")
    endif()
endforeach()

# Third-party code: no warnings in its sources, nor in our tests for its headers.
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
