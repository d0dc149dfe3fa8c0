# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Compiles, configures, parses or runs every block of code in every document, and checks that the tool knows every
command and option there.

    blocks.py BUILD COMPILER [C++-COMPILER]

BUILD is the folder of a complete build. Prints every mistake, and every block that could not be checked with the
reason."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import tools
from documents import HEADING, ROOT, documents, name, parse, report

WARNINGS = ["-Wall", "-Wextra", "-Werror", "-Wno-unused", "-Wno-unused-parameter"]
C = ["-std=c99", "-Ilib/include"]
CXX = ["-std=c++11", "-Ilib/include"]

# Documents whose C programs must also compile as C++.
BOTH = ("README.md",)
AS_CXX = ["-std=gnu++11", "-Wno-missing-field-initializers", "-x", "c++"]


def uses(header, *folders):
    """Options for the prelude of this name and for the tests' stand-ins, without warnings from their headers."""
    return ["-Itest/docs/prelude", "-include", f"test/docs/prelude/{header}.h",
            *(word for folder in folders for word in ("-isystem", f"test/{folder}"))]


BOARD = [*C, *uses("board")]
HAL = [*C, "-Iport/stm32", "-DSTM32_MODEL_SR", "-DSTM32_MODEL_STREAMS", "-DSTM32_MODEL_YEAR=2024"]
MODEL = ("port/stm32/stm32_model", "support")
STM32 = [*HAL, "-Iport/freertos", *uses("stm32", *MODEL, "port/freertos/kernel_stub"), "-Wno-pointer-to-int-cast"]
ARDUINO = [*CXX, "-Iport/arduino", "-isystem", "test/port/arduino/arduino_stub", "-DARDUINO=10819", "-DESP32",
           "-DESP_ARDUINO_VERSION_MAJOR=3"]

# Compiler options for each document, or for one of its sections; BOARD for all others.
CONTEXTS = {
    "README.md#On Arduino": ARDUINO,
    "examples/mavlink/README.md": [*BOARD, "-Iexamples/mavlink", "-DUSART2=USART1"],
    "examples/micro_ros/README.md": [*C, "-Iexamples/micro_ros", "-Iport/ros2/src",
                                     *uses("micro_ros", "port/micro_ros/micro_ros_stub")],
    "examples/stm32_cube/README.md": [*HAL, *uses("cube", *MODEL)],
    "port/README.md": [*C, "-Iport/template", *uses("template")],
    "port/arduino/README.md": ARDUINO,
    "port/esp32/README.md": [*C, "-Iport/esp32", *uses("board", "port/esp32/esp_idf")],
    "port/freertos/README.md": [*C, "-Iport/freertos", *uses("board", "port/freertos/kernel_stub")],
    "port/pico/README.md": [*C, "-std=gnu99", "-Iport/pico", *uses("board", "port/pico/sdk_stub")],
    "port/stm32/README.md": STM32,
    "port/stm32/README.md#With registers or LL": [*STM32, "-DREGISTERS"],
    "port/stm32/README.md#By DMA": [*STM32, "-DREGISTERS", "-DBY_DMA"],
    "port/stm32/README.md#Where the buffer may lie": [*STM32, "-DH7"],
    "port/stm32/README.md#Two lidars": [*STM32, "-DTWO_LIDARS"],
    "port/stm32/README.md#With an RTOS": [*STM32, "-DRTOS"],
    "port/zephyr/README.md": [*C, "-Iport/zephyr", *uses("board", "port/zephyr/zephyr_stub")],
    "test/simulator/README.md": [*C, "-Itest/simulator", "-Itest/support", *uses("a_test")],
}

# Zephyr's own settings. All others must be in a Kconfig file of this project.
ZEPHYR_SETTINGS = ("CONFIG_SERIAL",)

# Macros that expand to definitions: they are not statements.
DEFINING = ("TMINI_PICO_RING",)


class Failed(Exception):
    """A block is wrong."""


class Missing(Exception):
    """A block cannot be checked here."""


def run(*command, **options):
    try:
        result = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
                                **options)
    except FileNotFoundError as error:
        raise Missing(f"{command[0]} is not installed") from error
    if result.returncode != 0:
        raise Failed(result.stdout.strip())


# ---------------------------------------------------------------------------------- C and C++


def items(text):
    """Splits a program into its items at the outermost level, each as (number of line, text)."""
    found, lines, depth, first = [], [], 0, 1
    for number, line in enumerate(text.splitlines(), 1):
        if not lines:
            first = number
        lines.append(line)
        code = re.sub(r"/\*.*?\*/|//.*|\"(\\.|[^\"])*\"|'(\\.|[^'])'", "", line)
        depth += len(re.findall(r"[({\[]", code)) - len(re.findall(r"[)}\]]", code))
        comment_open = "\n".join(lines).count("/*") > "\n".join(lines).count("*/")
        ends = not code.strip() or code.rstrip().endswith((";", "}")) or code.startswith("#")
        if depth == 0 and ends and not comment_open:
            found.append((first, "\n".join(lines)))
            lines = []
    if lines:
        found.append((first, "\n".join(lines)))
    return found


def is_statement(item):
    code = re.sub(r"/\*.*?\*/|//[^\n]*", "", item, flags=re.DOTALL).strip()
    if not code or code.startswith("#") or code.startswith(DEFINING):
        return False
    if re.match(r"(static|extern|typedef|struct|enum|union)\b", code):
        return False
    if re.match(r"(if|for|while|switch|do|return)\b", code):
        return True
    if re.match(r"[\w\s*]+\([^;{]*\)\s*\{", code):
        return False
    # A declaration of a function, or of a variable without an initial value, is no statement.
    return not re.match(r"[A-Za-z_]\w*[\s*]+\w+(\[[^]]*\]|\([^()]*\))?;$", code)


def program(block):
    """The block as a program: its statements become the body of a function."""
    outside, inside = [], []
    for number, item in items(block.text):
        line = f'#line {block.number + number - 1} "{name(block.path)}"'
        (inside if is_statement(item) else outside).append(f"{line}\n{item}")
    if inside:
        outside += ["void statements(void);", "void statements(void)", "{", *inside, "}"]
    return "\n".join(outside) + "\n"


def check_c(block, place, language="c"):
    compiler = place.compilers[language]
    if not compiler:
        raise Missing(f"there is no compiler for {language}")
    document = name(block.path)
    flags = CONTEXTS.get(f"{document}#{block.section}") or CONTEXTS.get(document) or BOARD
    text = program(block) if language == "c" else block.text
    run(compiler, "-fsyntax-only", *WARNINGS, *flags, "-x", language, "-", input=text, cwd=ROOT)
    if document in BOTH and language == "c" and place.compilers["c++"]:
        run(place.compilers["c++"], "-fsyntax-only", *WARNINGS, *flags[1:], *AS_CXX, "-", input=text, cwd=ROOT)


def check_cxx(block, place):
    check_c(block, place, "c++")


# -------------------------------------------------------------------------------------- CMake

CMAKE_BEFORE = """cmake_minimum_required(VERSION 3.16)
project(my_project C)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/main.c "int main(void) { return 0; }")
foreach(executable my_project my_program firmware)
    add_executable(${executable} ${CMAKE_CURRENT_BINARY_DIR}/main.c)
endforeach()
# Libraries of the Pico SDK.
foreach(library hardware_dma hardware_gpio hardware_irq hardware_sync hardware_uart pico_time)
    add_library(${library} INTERFACE)
endforeach()
"""

LIBRARY = re.compile(r"\b(add_subdirectory|FetchContent_MakeAvailable|find_package|include)\(")
USE = "target_link_libraries("


def installed(place):
    """Installs this build once, for find_package(), and returns the folder."""
    prefix = place.folder / "installed"
    if not prefix.exists():
        run("cmake", "--install", place.build, "--prefix", prefix)
    return prefix


def generator(place):
    """Returns this build's generator: CMake's default one may not be installed."""
    cache = (place.build / "CMakeCache.txt").read_text(encoding="utf-8")
    return re.search(r"^CMAKE_GENERATOR:INTERNAL=(.*)$", cache, re.MULTILINE)[1]


def check_cmake(block, place):
    """Configures a project that ends with the block."""
    project = place.folder / f"cmake-{block.number}"
    shutil.rmtree(project, ignore_errors=True)
    (project / "third_party").mkdir(parents=True)
    (project / "third_party" / "tmini").symlink_to(ROOT, target_is_directory=True)
    (project / "Core" / "Src").mkdir(parents=True)
    shutil.copy(ROOT / "examples/stm32_cube/lidar.c", project / "Core" / "Src")
    text = block.text
    for shown in ("/path/to/tmini", "path/to/tmini"):
        text = text.replace(shown, "${CMAKE_CURRENT_SOURCE_DIR}/third_party/tmini")
    if not LIBRARY.search(text):
        text = "add_subdirectory(third_party/tmini)\n" + text
    if USE not in text and "include(" not in text.replace("include(FetchContent)", ""):
        text += "target_link_libraries(firmware PRIVATE tmini::tmini)\n"
    (project / "CMakeLists.txt").write_text(CMAKE_BEFORE + text)
    run("cmake", "-S", project, "-B", project / "build", "-G", generator(place),
        f"-DFETCHCONTENT_SOURCE_DIR_TMINI={ROOT}", f"-DCMAKE_PREFIX_PATH={installed(place)}",
        f"-DCMAKE_C_COMPILER={place.compilers['c']}")


# ---------------------------------------------------------------------------------- the others


def check_sh(block, _place):
    run("sh", "-n", input=block.text)
    # SC2034: variables may be used by the commands that follow. SC2164: the reader's folders exist.
    run("shellcheck", "-s", "sh", "-e", "SC2034,SC2164", "-", input=block.text)
    for option in re.findall(r"-D([A-Z_]+)=", block.text):
        if option.startswith(("CMAKE_", "PICO_")):
            continue
        if not any(option in path.read_text(encoding="utf-8")
                   for path in [*ROOT.glob("**/CMakeLists.txt"), *ROOT.glob("**/*.[ch]")]
                   if "build" not in path.relative_to(ROOT).parts[0]):
            raise Failed(f"nothing of this project knows {option}")


def check_yaml(block, _place):
    # Python's standard library has no YAML parser, but Ruby's has one.
    run("ruby", "-ryaml", "-e", "YAML.load($stdin.read)", input=block.text)


def check_conf(block, _place):
    known = "".join(path.read_text(encoding="utf-8") for path in (
        ROOT / "Kconfig", ROOT / "port/zephyr/Kconfig"))
    for line in block.text.splitlines():
        setting = re.fullmatch(r"(CONFIG_(\w+))=(y|n|\d+|0x[0-9a-fA-F]+|\"[^\"]*\")", line)
        if not setting:
            raise Failed(f"no setting: {line}")
        if setting[1] not in ZEPHYR_SETTINGS and not re.search(rf"config {setting[2]}$", known, re.MULTILINE):
            raise Failed(f"no such setting: {setting[1]}")


def check_dts(block, _place):
    compatible = re.findall(r'compatible = "([^"]*)"', block.text)
    for named in compatible:
        if not (ROOT / f"port/zephyr/dts/bindings/sensor/{named}.yaml").exists():
            raise Failed(f"there is no binding for {named}")
    board = "/dts-v1/;\n/ { uart0: uart-0 {}; uart1: uart-1 {}; };\n"
    run("dtc", "-q", "-o", os.devnull, "-", input=board + block.text)


def check_ld(block, place):
    script = place.folder / f"{block.number}.ld"
    script.write_text("MEMORY { RAM_D2 : ORIGIN = 0x30000000, LENGTH = 288K }\n"
                      "SECTIONS {\n" + block.text + "}\n")
    run("ld", "-r", "-T", script, "-o", os.devnull, "-b", "binary", script)


def check_python(block, _place):
    compile(block.text, str(block), "exec")


def check_text(_block, _place):
    raise Missing("what a program prints, a drawing or a formula: nothing to compile")


def check_unknown(block, _place):
    raise Failed(f"no check for the language \"{block.language}\"")


CHECKS = {"c": check_c, "cpp": check_cxx, "cmake": check_cmake, "sh": check_sh, "yaml": check_yaml, "conf": check_conf,
          "dts": check_dts, "ld": check_ld, "python": check_python, "text": check_text}


class Place:
    """The folders and compilers for a build."""

    def __init__(self, build, compiler, cxx_compiler):
        self.build = Path(build).resolve()
        self.compilers = {"c": compiler, "c++": cxx_compiler}
        self.folder = self.build / "test" / "docs" / "blocks"
        self.folder.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(self.folder / "installed", ignore_errors=True)


def main():
    place = Place(sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else None)
    complaints, unchecked, checked = tools.check(place.build), {}, 0
    for path in documents():
        blocks, prose = parse(path)
        complaints += [f"{name(path)}:{number}: code without a fence and a language"
                       for (_, before), (number, line) in zip(prose, prose[1:])
                       if re.match(r" {4,}\S", line) and (not before.strip() or HEADING.match(before))]
        for block in blocks:
            try:
                CHECKS.get(block.language, check_unknown)(block, place)
                checked += 1
            except (Failed, SyntaxError) as wrong:
                complaints.append(f"{block}: {wrong}")
            except Missing as reason:
                unchecked.setdefault(str(reason), []).append(str(block))
    for reason, places in unchecked.items():
        print(f"not checked, {reason}: {', '.join(places)}")
    report(complaints, checked, 40, "blocks")


main()
