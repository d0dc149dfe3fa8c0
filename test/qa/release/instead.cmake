# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Included by project(tmini). At the end of the configuration, it replaces the sources of the
# library's target by the one file in TMINI_SINGLE, with its headers.

function(tmini_use_single_file)
    set_target_properties(tmini PROPERTIES SOURCES ${TMINI_SINGLE}/tmini_all.c
        INCLUDE_DIRECTORIES ${TMINI_SINGLE} INTERFACE_INCLUDE_DIRECTORIES ${TMINI_SINGLE})
endfunction()

cmake_language(DEFER CALL tmini_use_single_file)
