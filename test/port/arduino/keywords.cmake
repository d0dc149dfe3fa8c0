# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Checks that keywords.txt lists each public method and each event, and no other name.
#   cmake -D ROOT=FOLDER -P keywords.cmake

cmake_minimum_required(VERSION 3.16)

file(READ ${ROOT}/port/arduino/TMiniLidar.h header)
file(READ ${ROOT}/lib/include/tmini/tmini.h events)
file(STRINGS ${ROOT}/port/arduino/TMiniLidar.h lines)
file(STRINGS ${ROOT}/port/arduino/keywords.txt keywords)

set(known "")
foreach(keyword IN LISTS keywords)
    string(REGEX REPLACE "\t.*" "" name "${keyword}")
    list(APPEND known ${name})
    if(NOT "${header} ${events}" MATCHES "[^A-Za-z_]${name}[^A-Za-z_]")
        file(STRINGS ${ROOT}/lib/include/tmini/tmini_types.h found REGEX "[^A-Z_]${name}[^A-Z_]")
        if(NOT found)
            message(SEND_ERROR "keywords.txt: there is no ${name}")
        endif()
    endif()
endforeach()

set(is_public NO)
foreach(line IN LISTS lines)
    if(line MATCHES "^(struct|  public:)")
        set(is_public YES)
    elseif(line MATCHES "^  (private|protected):")
        set(is_public NO)
    elseif(is_public AND line MATCHES "^    [a-z].*[ *&]([a-z][A-Za-z]+)\\(" AND
           NOT CMAKE_MATCH_1 IN_LIST known)
        message(SEND_ERROR "keywords.txt: ${CMAKE_MATCH_1} is missing")
    endif()
endforeach()
