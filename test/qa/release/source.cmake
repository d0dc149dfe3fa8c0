# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The source archive builds by the README's command, brings the tool and the simulated lidar, and
# can be installed; the tests are not in it. Where the viewer can be built, it comes out as the one
# released beside the archive.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

unpack(.tar.gz)
set(source ${WORK}/tmini-${VERSION})
expect_nothing_named(test_*.c *.bin)
build(${source})
run_or_fail(${WORK}/build/bin/tmini --help)
run_or_fail(${WORK}/build/bin/tmini-sim --help)
if(PAGE)
    run_or_fail(${CMAKE_COMMAND} --build ${WORK}/build --target web)
    run_or_fail(${CMAKE_COMMAND} -E compare_files
        ${WORK}/build/bin/tmini.html ${ARCHIVES}/tmini-${VERSION}.html)
endif()
run_or_fail(${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/prefix)
if(NOT EXISTS ${WORK}/prefix/include/tmini/tmini.h)
    message(FATAL_ERROR "nothing has been installed")
endif()
