# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Checks the source archive: it can be built, with the tool and the simulated lidar, has the sources
# of all tests and passes those that use the whole library, can be installed, and packs the same
# release again, including itself.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

unpack(-source.tar.gz)
set(source ${WORK}/tmini-${VERSION})
run_or_fail(${PYTHON} -B ${source}/.ci/pack.py --allow-placeholder ${WORK}/again)
run_or_fail(${CMAKE_COMMAND} -E compare_files ${WORK}/again/SHA256SUMS ${ARCHIVES}/SHA256SUMS)
configure(${source})
run_or_fail(${CMAKE_COMMAND} --build ${WORK}/build --parallel 2)
run_or_fail(${WORK}/build/bin/tmini --help)
run_or_fail(${WORK}/build/bin/tmini-sim --help)
run_or_fail(${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/prefix)
foreach(file include/tmini/tmini.h share/doc/tmini/LICENSE)
    if(NOT EXISTS ${WORK}/prefix/${file})
        message(FATAL_ERROR "not installed: ${file}")
    endif()
endforeach()

configure(${source} -DTMINI_BUILD_TESTS=ON)
test_driver_and_decoder()
