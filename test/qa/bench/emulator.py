# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs single functions of a program on an emulated processor and counts instructions.

The emulator reports every block that it enters; the program's bytes show how many instructions a block has. This is
exact, and is checked against single steps.
"""

import bisect
import collections

from elftools.elf.elffile import ELFFile
from unicorn import (UC_ARCH_ARM, UC_ARCH_RISCV, UC_HOOK_BLOCK, UC_HOOK_CODE, UC_MODE_MCLASS,
                     UC_MODE_RISCV32, UC_MODE_THUMB, Uc)
from unicorn import arm_const as arm
from unicorn import riscv_const as riscv

RAM = 0x20000000, 0x40000
STACK_TOP = 0x30010000
STACK_SIZE = 0x10000
STACK_FILL = 0xA7
RETURN = 0x00100000  # The return address of calls, outside of the program.

CORTEX = {"cortex-m0": arm.UC_CPU_ARM_CORTEX_M0, "cortex-m3": arm.UC_CPU_ARM_CORTEX_M3,
          "cortex-m4": arm.UC_CPU_ARM_CORTEX_M4}


# A calling convention. The first argument's register is the result's, too; `wide` is true for the lower half of a
# four-byte instruction.
Registers = collections.namedtuple("Registers", "arguments stack link thumb wide")
ARM = Registers((arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2), arm.UC_ARM_REG_SP, arm.UC_ARM_REG_LR, 1,
                lambda low_half: low_half >> 11 >= 0x1D)
RISCV = Registers((riscv.UC_RISCV_REG_A0, riscv.UC_RISCV_REG_A1, riscv.UC_RISCV_REG_A2), riscv.UC_RISCV_REG_SP,
                  riscv.UC_RISCV_REG_RA, 0, lambda low_half: low_half & 3 == 3)


class Machine:
    """A processor with a program in its memory."""

    def __init__(self, target_name, program):
        with open(program, "rb") as file:
            elf = ELFFile(file)
            symbols = list(elf.get_section_by_name(".symtab").iter_symbols())
            segments = [(s["p_vaddr"], s.data(), s["p_memsz"]) for s in elf.iter_segments() if s["p_type"] == "PT_LOAD"]
        self.addresses = {s.name: s["st_value"] & ~1 for s in symbols if s.name}
        self.sizes = {s.name: s["st_size"] for s in symbols}
        self.functions = sorted((s["st_value"] & ~1, s.name) for s in symbols if s["st_info"]["type"] == "STT_FUNC")
        self._starts = [start for start, _ in self.functions]
        self._make_processor(target_name)
        self._load(segments)
        self._blocks = {}     # (address, size) of a block: its instructions
        self._counted = {}   # address: whether it belongs to the library
        self.count = 0
        self.uc.hook_add(UC_HOOK_BLOCK, self._block)

    def save(self):
        return self.read(*RAM)

    def restore(self, saved):
        self.uc.mem_write(RAM[0], saved)

    def _make_processor(self, name):
        if name in CORTEX:
            self.uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
            self.uc.ctl_set_cpu_model(CORTEX[name])
            self.registers = ARM
        else:
            self.uc = Uc(UC_ARCH_RISCV, UC_MODE_RISCV32)
            self.registers = RISCV

    def _load(self, segments):
        self.uc.mem_map(0x00010000, 0x10000)
        self.uc.mem_map(*RAM)
        self.uc.mem_map(STACK_TOP - STACK_SIZE, STACK_SIZE)
        self.uc.mem_map(RETURN, 0x1000)
        for address, data, size in segments:
            self.uc.mem_write(address, data + bytes(size - len(data)))

    def function_at(self, address):
        """The name of the function that contains this instruction."""
        index = bisect.bisect_right(self._starts, address) - 1
        return self.functions[index][1] if index >= 0 else ""

    def _is_counted(self, address):
        return RETURN != address and not self.function_at(address).startswith("bench_")

    def _instructions(self, address, size):
        code = bytes(self.uc.mem_read(address, size))
        count = 0
        at = 0
        while at < size:
            at += 4 if self.registers.wide(code[at] | code[at + 1] << 8) else 2
            count += 1
        if at != size:
            raise RuntimeError(f"the block at 0x{address:x} ends inside an instruction")
        return count if self._is_counted(address) else 0

    def _block(self, _uc, address, size, _data):
        key = (address, size)
        count = self._blocks.get(key)
        if count is None:
            count = self._instructions(address, size) if address != RETURN else 0
            self._blocks[key] = count
        self.count += count

    def call(self, name, *arguments):
        """Calls a function; returns its result. Adds the library's instructions to `count`."""
        uc, registers = self.uc, self.registers
        for register, value in zip(registers.arguments, arguments):
            uc.reg_write(register, value)
        uc.reg_write(registers.stack, STACK_TOP)
        uc.reg_write(registers.link, RETURN | registers.thumb)
        uc.emu_start(self.addresses[name] | registers.thumb, RETURN)
        return uc.reg_read(registers.arguments[0])

    def cost(self, name, *arguments):
        """Calls a function; returns its result and the number of the library's instructions."""
        before = self.count
        result = self.call(name, *arguments)
        return result, self.count - before

    def write(self, name, data, offset=0):
        self.uc.mem_write(self.addresses[name] + offset, bytes(data))

    def read(self, address, size):
        return bytes(self.uc.mem_read(address, size))

    def write_word(self, name, value):
        self.write(name, value.to_bytes(4, "little"))

    def paint_stack(self):
        self.uc.mem_write(STACK_TOP - STACK_SIZE, bytes([STACK_FILL]) * STACK_SIZE)

    def stack_used(self):
        """How many bytes of stack have been written since it was painted."""
        stack = self.read(STACK_TOP - STACK_SIZE, STACK_SIZE)
        return len(stack.lstrip(bytes([STACK_FILL])))

    def single_steps(self, name, *arguments):
        """As cost(), but counts one instruction at a time, which is slow."""
        steps = 0

        def step(_uc, address, _size, _data):
            nonlocal steps
            steps += self._is_counted(address)

        self.uc.ctl_flush_tb()  # A hook is only added to code that is translated after it.
        hook = self.uc.hook_add(UC_HOOK_CODE, step)
        result = self.call(name, *arguments)
        self.uc.hook_del(hook)
        self.uc.ctl_flush_tb()
        return result, steps
