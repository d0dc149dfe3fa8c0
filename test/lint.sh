#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Checks the sources without running them: formatting and static analysis. Runs all checks, as many
# at a time as there are cores, then fails if any has found something.
#
#   test/lint.sh [--fix]       --fix first corrects the formatting of the files
#   test/lint.sh CHECK         one of them

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"

# The longest first.
checks="programs library analyzer firmware cxx cppcheck misra scripts format lengths"

need clang-format clang-format
need clang-tidy clang-tidy
need cppcheck cppcheck
need gcc gcc
need shellcheck shellcheck
need_build_tools
need_drawing

# The files of this project, without those in build folders; also works without git.
find_files() {
    find . -name 'build*' -prune -o -name '.git' -prune -o -type f \( "$@" \) -print
}

# format OPTION…
format() {
    find_files -name '*.c' -o -name '*.h' -o -name '*.cpp' | xargs clang-format "$@"
}

check_format() {
    format --dry-run -Werror
}

# Checks the length of all lines except in documents, where a paragraph may be one line.
check_lengths() {
    found=0
    find_files \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.ino' -o -name '*.sh' \
        -o -name '*.cmake' -o -name 'CMakeLists.txt' -o -name '*.ld' -o -name '*.yml' \
        -o -name 'Kconfig*' -o -path './.ci/run' -o -path './.ci/release' \) |
        LC_ALL=C.UTF-8 xargs grep -nE '^.{101,}' && found=1
    find_files \( -name '*.py' -o -name '*.js' \) |
        LC_ALL=C.UTF-8 xargs grep -nE '^.{121,}' && found=1
    return "$found"
}

# each_platform COMMAND: calls COMMAND "FILE…" FLAG… for the ports and examples of each platform,
# which are compiled as in their tests, with the stand-ins for the platform.
each_platform() {
    clean=0
    "$1" "port/template/*.c examples/common/*.c" -I port/template || clean=1
    "$1" "port/stm32/*.c examples/stm32_cube/*.c" -I port/stm32 -I examples/stm32_cube \
        -isystem test/port/stm32/stm32_model -isystem test/support || clean=1
    "$1" "examples/stm32f405_baremetal/*.c" -I port/stm32 || clean=1
    bridge="examples/bridge/main/main.c examples/bridge/main/web.c"
    "$1" "port/esp32/*.c examples/esp32_idf/main/*.c $bridge" \
        -I port/esp32 -I port/posix -I examples/bridge/core -isystem test/port/esp32/esp_idf ||
        clean=1
    "$1" "port/pico/*.c examples/pico/*.c" -I port/pico -D_DEFAULT_SOURCE \
        -isystem test/port/pico/sdk_stub || clean=1
    "$1" "port/zephyr/*.c examples/zephyr/src/*.c" -I port/zephyr -DZEPHYR_ASYNC \
        -isystem test/port/zephyr/zephyr_stub || clean=1
    "$1" "port/freertos/*.c examples/freertos/*.c" -I port/freertos -I examples/freertos \
        -isystem test/port/freertos/kernel_stub || clean=1
    "$1" "port/ros2/src/*.c examples/micro_ros/*.c" -I port/ros2/src \
        -isystem test/port/micro_ros/micro_ros_stub || clean=1
    return "$clean"
}

# tidy "FILE…" CHECKS FLAG…: clang-tidy says on standard error how much it has suppressed.
tidy() {
    files=$1 leave_out=$2
    shift 2
    # shellcheck disable=SC2086 # files are several words
    clang-tidy --quiet --checks="$leave_out" --header-filter="^$root/(lib|port|examples)/" \
        $files -- "$@" -I lib/include 2>/dev/null
}

# Addresses of registers are integers converted to pointers.
tidy_platform() {
    files=$1
    shift
    tidy "$files" -performance-no-int-to-ptr -std=c99 -I examples/common -I examples/obstacle_stop \
        "$@"
}

check_firmware() {
    each_platform tidy_platform
}

# In C++ unused parameters have no name. A positive number may be rounded by adding a half.
check_cxx() {
    clean=0
    tidy "port/arduino/*.cpp" -readability-named-parameter,-bugprone-incorrect-roundings \
        -std=c++11 -isystem test/port/arduino/arduino_stub \
        -DARDUINO=10819 -DESP32 -DESP_ARDUINO_VERSION_MAJOR=3 || clean=1
    tidy "port/ros2/src/settings.cpp port/ros2/src/report.cpp port/ros2/src/lidar.cpp" "" \
        -std=c++17 -I port/posix -I port/ros2/src || clean=1
    return "$clean"
}

configure() {
    quietly cmake -S . -B build-lint -DTMINI_BUILD_TESTS=OFF
}

# tidy_built FILE…: with the commands that cmake writes.
tidy_built() {
    clang-tidy --quiet -p build-lint --header-filter="^$root/(lib|port|examples)/" "$@" 2>/dev/null
}

check_library() {
    tidy_built lib/src/*.c port/posix/*.c
}

check_programs() {
    tidy_built examples/host/*.c examples/obstacle_stop/*.c examples/bridge/core/*.c \
        examples/bridge/pc/*.c
}

# Suppressed, because cppcheck
# - tries a configuration without any compiler's primitives, an intended #error;
# - assumes that the smaller of two values is always the same one of them;
# - does not find the users of structures' members and of private functions;
# - does not know the symbols that a linker script defines;
# - demands that constructors fill buffers;
# - criticises where a variable is declared, a matter of taste;
# - miscounts the arguments of formats made of macros, which compilers check better;
# - believes that a structure written through a pointer is read;
# - takes the library's headers for C++ where a C++ source includes them, and loops for algorithms;
# - reports, in newer versions, how thorough it was.
check_cppcheck() {
    cppcheck --quiet --std=c99 --enable=warning,style,performance,portability --inline-suppr \
        --suppress=preprocessorErrorDirective --suppress=knownConditionTrueFalse \
        --suppress=missingIncludeSystem --suppress=unusedStructMember \
        --suppress=unusedPrivateFunction --suppress=comparePointers \
        --suppress=uninitMemberVar --suppress=variableScope --suppress=badBitmaskCheck \
        --suppress=wrongPrintfScanfArgNum \
        --suppress=zerodivcond --suppress=ctuuninitvar \
        --suppress='cstyleCast:lib/*' --suppress=useStlAlgorithm \
        --suppress=normalCheckLevelMaxBranches --error-exitcode=1 \
        -I lib/include -I examples/common -I examples/obstacle_stop lib/src port examples
}

# Only the rules listed in test/misra.txt, each with a reason, may be broken.
check_misra() {
    broken=$(cppcheck --addon=misra --quiet --std=c99 --enable=style \
        --template='{id} {file}:{line}' --suppress=missingIncludeSystem \
        --suppress=preprocessorErrorDirective -D__GNUC__=12 -U__AVR__ \
        -UTMINI_ATOMIC_HEADER -I lib/include lib/src 2>&1 |
        sed -n 's/^misra-c2012-\([0-9.]*\) /\1 /p' | sort -u)
    [ -n "$broken" ] || { echo "cppcheck's MISRA addon says nothing at all"; return 1; }
    ! printf '%s\n' "$broken" | awk '
        FILENAME != "-" { if ($1 ~ /^[0-9]/) known[$1] = 1; next }
        !($1 in known) { print "rule " $1 ", not in test/misra.txt: " $2; found = 1 }
        END { exit !found }' test/misra.txt -
}

# analyse "FILE…" FLAG…: GCC's own analyser.
analyse() {
    files=$1 found=0
    shift
    for source in $files; do
        gcc -std=c99 -O2 -fanalyzer -Werror -S -o /dev/null -Ilib/include -Iexamples/common \
            -Iexamples/obstacle_stop "$@" "$source" || found=1
    done
    return "$found"
}

# In examples/host it overlooks the only branch that closes a file, and believes that finding an
# existing entry may fail.
check_analyzer() {
    clean=0
    analyse "lib/src/*.c port/posix/*.c examples/obstacle_stop/obstacle*.c" || clean=1
    # shellcheck disable=SC2046 # flags are several words
    analyse "examples/host/*.c" -Iport/posix $(pkg-config --cflags cairo) \
        -Wno-analyzer-file-leak -Wno-analyzer-malloc-leak -Wno-analyzer-null-dereference || clean=1
    each_platform analyse || clean=1
    return "$clean"
}

check_scripts() {
    find_files -name '*.sh' -o -path './.ci/run' -o -path './.ci/release' | xargs shellcheck -x
}

# check NAME
check() {
    if "check_$1" >"build-lint/$1.log" 2>&1; then
        echo "clean: $1"
    else
        cat "build-lint/$1.log"
        echo "NOT CLEAN: $1"
        return 1
    fi
}

cd "$root"
case " $checks --fix " in
    *" ${1:---fix} "*) ;;
    *)
        sed -n '7,8s/^# \{0,1\}//p' "$0" >&2
        echo "  CHECK: $checks" >&2
        exit 2
        ;;
esac
case ${1:-} in
    "" | --fix)
        install_tools
        configure
        ;;
    *)
        [ -d build-lint ] || configure
        check "$1"
        exit
        ;;
esac
[ $# -eq 0 ] || format -i
# shellcheck disable=SC2086 # checks are several words
if ! printf '%s\n' $checks | xargs -n 1 -P "$(job_count)" "$0"; then
    echo "Not clean: see above."
    exit 1
fi
echo "All clean."
