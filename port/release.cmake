# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Packs what users download: cmake --build build --target release, then look into build/release. Or
#
#   cmake -D VERSION=X.Y.Z -D OUT=DIR [-D PAGE=tmini.html] -P port/release.cmake
#
#   tmini-X.Y.Z.tar.gz              the sources: library, ports, examples, documents; no tests
#   tmini-X.Y.Z-arduino.zip         for the Arduino IDE: Sketch > Include Library > Add .ZIP Library
#   tmini-X.Y.Z-esp-idf.zip         a component: to be unpacked in a project's folder components
#   tmini-X.Y.Z-platformio.tar.gz   a library for lib_deps; in it what library.json exports
#   tmini-X.Y.Z.html                the viewer, if PAGE has been built

# The same file, included by CMakeLists.txt, is where the target comes from.

if(NOT CMAKE_SCRIPT_MODE_FILE)
    set(release_page "")
    if(TARGET web AND NOT TMINI_WEB_MISSING)
        set(release_page -D PAGE=${PROJECT_BINARY_DIR}/bin/tmini.html)
    endif()
    add_custom_target(release
        COMMAND ${CMAKE_COMMAND} -D VERSION=${TMINI_VERSION} -D OUT=${PROJECT_BINARY_DIR}/release
            ${release_page} -P ${CMAKE_CURRENT_LIST_FILE}
        COMMENT "Packing the release"
        VERBATIM)
    if(release_page)
        add_dependencies(release web)
    endif()
    return()
endif()

# string(JSON).
cmake_minimum_required(VERSION 3.19)

get_filename_component(root ${CMAKE_CURRENT_LIST_DIR}/.. ABSOLUTE)
get_filename_component(out ${OUT} ABSOLUTE)
set(work ${out}/work)

set(documents CHANGELOG.md LICENSE README.md)

# The examples need the simulated lidar, and that the encoder.
set(source_contents ${documents} CONTRIBUTING.md SECURITY.md
    CMakeLists.txt CMakePresets.json Kconfig idf_component.yml library.json
    docs examples lib port zephyr test/CMakeLists.txt test/simulator test/support)

# What the component manager packs.
file(STRINGS ${root}/idf_component.yml manifest)
string(REGEX REPLACE "^.*;  include:;" "" manifest "${manifest}")
string(REGEX MATCHALL "    - [^;]+" manifest "${manifest}")
set(esp_idf_contents "")
foreach(line ${manifest})
    string(REPLACE "    - " "" pattern ${line})
    file(GLOB names RELATIVE ${root} ${root}/${pattern})
    list(APPEND esp_idf_contents ${names})
endforeach()

file(READ ${root}/library.json manifest)
string(JSON count LENGTH "${manifest}" export include)
set(platformio_contents library.json)
foreach(i RANGE 1 ${count})
    math(EXPR i "${i} - 1")
    string(JSON name GET "${manifest}" export include ${i})
    list(APPEND platformio_contents ${name})
endforeach()

# Sets RESULT to the files of the project, without what building leaves between them.
function(list_files result)
    if(EXISTS ${root}/.git)
        execute_process(COMMAND git -C ${root} -c core.quotePath=off ls-files
            OUTPUT_VARIABLE files RESULT_VARIABLE status)
        if(status EQUAL 0)
            string(REPLACE "\n" ";" files "${files}")
            set(${result} ${files} PARENT_SCOPE)
            return()
        endif()
    endif()
    file(GLOB_RECURSE files RELATIVE ${root} ${root}/*)
    list(FILTER files EXCLUDE REGEX "(^|/)(build[^/]*|\\.git|\\.pio)/")
    list(FILTER files EXCLUDE REGEX "(^|/)(managed_components|__pycache__)/")
    list(FILTER files EXCLUDE REGEX "(^|/)(sdkconfig|sdkconfig\\.old|dependencies\\.lock)$")
    set(${result} ${files} PARENT_SCOPE)
endfunction()

# gather(FOLDER FILE|FOLDER…): copies what the project has under these names.
function(gather folder)
    foreach(file ${files})
        foreach(name ${ARGN})
            string(FIND "${file}/" "${name}/" position)
            if(position EQUAL 0 AND EXISTS ${root}/${file})
                get_filename_component(subfolder ${folder}/${file} DIRECTORY)
                file(COPY ${root}/${file} DESTINATION ${subfolder})
            endif()
        endforeach()
    endforeach()
endfunction()

# pack(ENDING FOLDER FLAGS [FORMAT]): what is in FOLDER as the archive tmini-VERSION-ENDING.
function(pack ending folder flags)
    file(GLOB contents RELATIVE ${folder} ${folder}/*)
    set(archive ${out}/tmini-${VERSION}${ending})
    execute_process(COMMAND ${CMAKE_COMMAND} -E tar ${flags} ${archive} ${ARGN} ${contents}
        WORKING_DIRECTORY ${folder} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "${archive} could not be written")
    endif()
    message("${archive}")
endfunction()

list_files(files)
list(FILTER files EXCLUDE REGEX "^test/.*/test_")
file(REMOVE_RECURSE ${out})

gather(${work}/source/tmini-${VERSION} ${source_contents})
pack(.tar.gz ${work}/source czf)

execute_process(
    COMMAND ${CMAKE_COMMAND} -D OUT=${work}/arduino/tmini -P ${root}/port/arduino/pack.cmake
    RESULT_VARIABLE status)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "the Arduino library could not be packed")
endif()
pack(-arduino.zip ${work}/arduino cf --format=zip)

gather(${work}/esp-idf/tmini ${esp_idf_contents})
pack(-esp-idf.zip ${work}/esp-idf cf --format=zip)

# PlatformIO wants library.json at the top.
gather(${work}/platformio ${platformio_contents})
pack(-platformio.tar.gz ${work}/platformio czf)

if(PAGE)
    configure_file(${PAGE} ${out}/tmini-${VERSION}.html COPYONLY)
    # The page that lies ready in the repository is renewed here and nowhere else.
    configure_file(${PAGE} ${root}/examples/web/tmini.html COPYONLY)
    message("${out}/tmini-${VERSION}.html")
endif()
file(REMOVE_RECURSE ${work})
