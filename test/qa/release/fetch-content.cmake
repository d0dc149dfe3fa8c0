# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The source archive, by FetchContent in another project.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

file(REMOVE_RECURSE ${WORK})
build(${CMAKE_CURRENT_LIST_DIR}/fetch_content -DARCHIVE=${ARCHIVES}/tmini-${VERSION}-source.tar.gz)
run_or_fail(${WORK}/build/consumer)
