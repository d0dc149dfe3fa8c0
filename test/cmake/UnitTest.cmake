# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# tmini_add_unit_test(NAME
#     [SOURCES test_file.c more.c …]   the first one holds the tests: void test_…(void); by default
#                                      NAME.c alone
#     [SHARED file.c …]                sources whose tests run, too, before those of the first one
#     [MOCKS header.h …]               functions declared there are mocked; in the test file,
#                                      #include "mock_header.h"
#     [LIBRARIES target …]             linked besides the library, Unity and CMock
#     [LABEL label]                    of the ctest; by default TMINI_TEST_LABEL, the folder's
#     [NOT_ON machine …]               emulated machines it does not run on: for example `int16` if
#                                      its arrays do not fit in 8 KB of RAM; `others` means all
#                                      emulated machines
# )
#
# Adds one executable and one ctest. The main function (the "runner") and the mocks are generated at
# build time. OtherMachines.cmake explains which tests are also built for other machines.

set(TMINI_CMOCK_CONFIG ${CMAKE_CURRENT_LIST_DIR}/cmock.yml)

# Sets OUT to the runner made in the folder DIR for the test file SOURCE, and for SHARED if given.
function(tmini_generate_runner out source dir shared)
    set(generator ${TMINI_UNITY_DIR}/auto/generate_test_runner.rb)
    set(runner ${dir}/runner.c)
    set(shorten "")
    if(TMINI_TEST_SHORT_NAMES)
        # AVR copies strings to RAM, and names that are sentences would fill most of it. The line
        # number in the report still identifies the test.
        set(shorten COMMAND sed -i -E "s/(run_test\\([a-zA-Z0-9_]+, )\"[^\"]*\"/\\1\"\"/" ${runner})
    endif()
    get_filename_component(test_dir ${source} DIRECTORY)
    get_filename_component(test_file ${source} NAME)
    if(shared)
        set(both "")
        foreach(file ${shared} ${source})
            file(READ ${file} text)
            string(APPEND both "${text}")
        endforeach()
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${shared} ${source})
        set(test_dir ${dir})
        set(source ${dir}/${test_file})
        file(GENERATE OUTPUT ${source} CONTENT "${both}")
    endif()
    # Run in the folder of the test file: then reports name "test_x.c" without a path. -W0 turns off
    # Ruby's warnings about the generator's own code.
    add_custom_command(OUTPUT ${runner}
        COMMAND ${TMINI_RUBY} -W0 ${generator} ${TMINI_CMOCK_CONFIG} ${test_file} ${runner}
        ${shorten}
        DEPENDS ${source} ${generator} ${TMINI_CMOCK_CONFIG}
        WORKING_DIRECTORY ${test_dir}
        COMMENT "Generating the runner of ${test_file}"
        VERBATIM
    )
    set(${out} ${runner} PARENT_SCOPE)
endfunction()

# Sets OUT to the sources of mocks made for the given headers in the folder DIR.
function(tmini_generate_mocks out dir)
    set(mocks "")
    foreach(header ${ARGN})
        get_filename_component(header ${header} ABSOLUTE)
        get_filename_component(name ${header} NAME_WE)
        set(mock ${dir}/mock_${name}.c)
        # CMock writes to its working directory. A path given as an option would be misread if it
        # contained unusual characters.
        add_custom_command(OUTPUT ${mock} ${dir}/mock_${name}.h
            COMMAND ${TMINI_RUBY} -W0 ${TMINI_CMOCK_DIR}/lib/cmock.rb
                -o${TMINI_CMOCK_CONFIG} ${header}
            DEPENDS ${header} ${TMINI_CMOCK_CONFIG}
            WORKING_DIRECTORY ${dir}
            COMMENT "Generating mock_${name}"
            VERBATIM
        )
        list(APPEND mocks ${mock})
    endforeach()
    set(${out} ${mocks} PARENT_SCOPE)
endfunction()

# Sets the include folders, options and libraries of the executable TARGET.
function(tmini_configure_unit_test target generated_dir)
    target_include_directories(${target} PRIVATE ${generated_dir})
    foreach(header ${ARGN})
        get_filename_component(header_dir ${header} DIRECTORY)
        target_include_directories(${target} PRIVATE ${header_dir})
    endforeach()
    target_link_libraries(${target} PRIVATE tmini_cmock tmini::tmini)
    set_target_properties(${target} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON)
    target_compile_options(${target} PRIVATE -Wall -Wextra $<$<BOOL:${TMINI_WERROR}>:-Werror>)
endfunction()

function(tmini_add_unit_test name)
    cmake_parse_arguments(arg "" "LABEL" "SOURCES;SHARED;MOCKS;LIBRARIES;NOT_ON" ${ARGN})
    if(arg_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR
            "tmini_add_unit_test(${name}): not understood: ${arg_UNPARSED_ARGUMENTS}")
    endif()
    if(NOT arg_SOURCES)
        set(arg_SOURCES ${name}.c)
    endif()
    if(TMINI_TEST_MACHINE IN_LIST arg_NOT_ON OR
            (CMAKE_CROSSCOMPILING AND "others" IN_LIST arg_NOT_ON))
        return()
    endif()
    if(NOT arg_LABEL)
        set(arg_LABEL ${TMINI_TEST_LABEL})
    endif()

    set(dir ${CMAKE_CURRENT_BINARY_DIR}/${name}.generated)
    file(MAKE_DIRECTORY ${dir})
    list(GET arg_SOURCES 0 test_file)
    get_filename_component(test_file ${test_file} ABSOLUTE)
    set(shared "")
    foreach(file ${arg_SHARED})
        get_filename_component(file ${file} ABSOLUTE) # Ninja wants one name for each file.
        list(APPEND shared ${file})
    endforeach()
    list(APPEND arg_SOURCES ${shared})
    tmini_generate_runner(runner ${test_file} ${dir} "${shared}")
    tmini_generate_mocks(mocks ${dir} ${arg_MOCKS})
    set_source_files_properties(${runner} ${mocks} PROPERTIES COMPILE_OPTIONS -w)

    add_executable(${name} ${arg_SOURCES} ${runner} ${mocks})
    tmini_configure_unit_test(${name} ${dir} ${arg_MOCKS})
    target_link_libraries(${name} PRIVATE ${arg_LIBRARIES})
    tmini_add_check(${name} ${arg_LABEL} COMMAND ${name} NEEDS ${name})
    if(TMINI_TEST_PASS_PATTERN) # A machine without exit statuses: the printed text decides.
        set_tests_properties(${name} PROPERTIES
            PASS_REGULAR_EXPRESSION "${TMINI_TEST_PASS_PATTERN}"
            FAIL_REGULAR_EXPRESSION "${TMINI_TEST_FAIL_PATTERN}")
    endif()
endfunction()
