# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that the interrupt handlers for STM32 USARTs in documents survive an overrun, on a model of a USART with SR
and DR (only reading SR and then DR clears the overrun), or with ISR, RDR and ICR (only writing to ICR does).

    handlers.py BUILD C++-COMPILER
"""

import re
import subprocess
import sys
from pathlib import Path

from documents import documents, parse, report

HANDLER = re.compile(r"^void USART1_IRQHandler\(void\).*?^}\n", re.MULTILINE | re.DOTALL)

PROGRAM = """
#include <cstdint>
#include <cstdio>
#include <vector>

enum : uint32_t { ORE = 1u << 3, RXNE = 1u << 5 };

static uint32_t status;
static uint8_t data;
static bool is_ore_seen;

/* Flags behave as in the reference manuals. */
struct Status {
    operator uint32_t() const
    {
        is_ore_seen = (status & ORE) != 0;
        return status;
    }
};
struct Data {
    operator uint32_t() const
    {
        status &= ~(RXNE | (HAS_SR && is_ore_seen ? ORE : 0u));
        is_ore_seen = false;
        return data;
    }
};
struct Clear {
    void operator=(uint32_t flags) { status &= ~(flags & ORE); }
};

enum : uint32_t { USART_SR_ORE = ORE, USART_SR_RXNE = RXNE, USART_ISR_ORE = ORE, USART_ISR_RXNE = RXNE,
                  USART_ICR_ORECF = ORE };
#if HAS_SR
static struct { Status SR; Data DR; } registers;
#else
static struct { Status ISR; Data RDR; Clear ICR; } registers;
#endif
static decltype(registers) *const USART1 = &registers;

static void receive(uint8_t byte)
{
    data = (status & RXNE) != 0 ? data : byte;
    status |= (status & RXNE) != 0 ? ORE : RXNE;
}

static int lidar;
static std::vector<uint8_t> fed;

static void tmini_feed_byte(int *, uint8_t byte) { fed.push_back(byte); }

HANDLER

/* Calls the handler while the USART requests an interrupt; false if this does not end. */
static bool serve()
{
    for (int i = 0; i < 10 && status != 0; i++) {
        USART1_IRQHandler();
    }
    return status == 0;
}

static bool receives(uint8_t byte)
{
    receive(byte);
    return serve() && !fed.empty() && fed.back() == byte;
}

static const char *wrong()
{
    if (!receives(0x11)) {
        return "it does not receive";
    }
    receive(0x22);
    receive(0x33);
    if (!serve()) {
        return "an overrun interrupts for ever";
    }
    status = ORE;
    if (!serve()) {
        return "an overrun without a byte interrupts for ever";
    }
    if (fed.size() != 2 || fed[1] != 0x22) {
        return "an overrun feeds a byte twice";
    }
    return receives(0x44) ? "" : "it receives no more";
}

int main()
{
    const char *const text = wrong();
    return std::puts(text) < 0 || *text != 0;
}
"""


def handlers():
    for path in documents():
        for block in parse(path)[0]:
            for handler in HANDLER.findall(block.text):
                if block.language == "c" and "USART1->" in handler:
                    yield block, handler


def survives(handler, folder, compiler):
    program = folder / "handler"
    kind = "-DHAS_SR=" + str(int("->DR" in handler))
    built = subprocess.run([compiler, "-std=c++11", kind, "-x", "c++", "-", "-o", program],
                           input=PROGRAM.replace("HANDLER\n", handler), stdout=subprocess.PIPE,
                           stderr=subprocess.STDOUT, text=True, check=False)
    if built.returncode != 0:
        return built.stdout
    result = subprocess.run([program], text=True, stdout=subprocess.PIPE, check=False)
    return result.stdout if result.returncode != 0 else None


folder = Path(sys.argv[1]) / "test" / "docs" / "handlers"
folder.mkdir(parents=True, exist_ok=True)
for data in ("DR", "RDR"):
    naive = f"tmini_feed_byte(&lidar, (uint8_t)USART1->{data});"
    if survives(f"void USART1_IRQHandler(void) {{ {naive} }}\n", folder, sys.argv[2]) is None:
        sys.exit(f"a handler that reads {data} alone seems to survive: is this check still one?")
tried = [(block, survives(handler, folder, sys.argv[2])) for block, handler in handlers()]
report([f"{block}: {wrong.strip()}" for block, wrong in tried if wrong is not None], len(tried), 3, "handlers")
