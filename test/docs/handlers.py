# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that the interrupt handlers for STM32 USARTs in documents survive an overrun, on a model of a USART with SR
and DR (only reading SR and then DR clears the overrun), or with ISR, RDR and ICR (only writing to ICR does).

    handlers.py BUILD C++-COMPILER

Exit status: 0 all survive, 1 not.
"""

import re
import subprocess
import sys
from pathlib import Path

from documents import documents, parse

HANDLER = re.compile(r"^void USART1_IRQHandler\(void\).*?^}\n", re.MULTILINE | re.DOTALL)

PROGRAM = """
#include <cstdint>
#include <cstdio>
#include <vector>

enum : uint32_t { ORE = 1u << 3, RXNE = 1u << 5 };

/* Flags behave as in the reference manuals. */
struct Usart {
    uint32_t status = 0;
    uint8_t data = 0;
    bool is_ore_seen = false;

    struct Register {
        Usart *usart;
    };
    struct Status : Register {
        operator uint32_t() const
        {
            usart->is_ore_seen = (usart->status & ORE) != 0;
            return usart->status;
        }
    };
    struct Data : Register {
        operator uint32_t() const
        {
            usart->status &= ~(RXNE | (HAS_SR && usart->is_ore_seen ? ORE : 0u));
            usart->is_ore_seen = false;
            return usart->data;
        }
    };
    struct Clear : Register {
        void operator=(uint32_t flags)
        {
            usart->status &= ~(flags & ORE);
        }
    };
#if HAS_SR
#define USART_SR_ORE ORE
#define USART_SR_RXNE RXNE
    Status SR;
    Data DR;
    Usart() { SR.usart = this; DR.usart = this; }
#else
#define USART_ISR_ORE ORE
#define USART_ISR_RXNE RXNE
#define USART_ICR_ORECF ORE
    Status ISR;
    Data RDR;
    Clear ICR;
    Usart() { ISR.usart = this; RDR.usart = this; ICR.usart = this; }
#endif

    void receive(uint8_t byte)
    {
        if ((status & RXNE) != 0) {
            status |= ORE;
        } else {
            data = byte;
            status |= RXNE;
        }
    }
};

static Usart registers;
static Usart *const USART1 = &registers;
static int lidar;
static std::vector<uint8_t> fed;

static void tmini_feed_byte(int *, uint8_t byte)
{
    fed.push_back(byte);
}

HANDLER

/* Calls the handler while the USART requests an interrupt; false if this does not end. */
static bool serve()
{
    for (int i = 0; i < 10; i++) {
        if (registers.status == 0) {
            return true;
        }
        USART1_IRQHandler();
    }
    return false;
}

static bool receives(uint8_t byte)
{
    registers.receive(byte);
    return serve() && !fed.empty() && fed.back() == byte;
}

int main()
{
    if (!receives(0x11)) {
        return std::puts("it does not receive"), 1;
    }
    registers.receive(0x22);
    registers.receive(0x33);
    if (!serve()) {
        return std::puts("an overrun interrupts for ever"), 1;
    }
    registers.status = ORE;
    if (!serve()) {
        return std::puts("an overrun without a byte interrupts for ever"), 1;
    }
    return receives(0x44) && fed[1] == 0x22 ? 0 : (std::puts("it receives no more"), 1);
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


def main():
    folder = Path(sys.argv[1]) / "test" / "docs" / "handlers"
    folder.mkdir(parents=True, exist_ok=True)
    for data in ("DR", "RDR"):
        naive = f"tmini_feed_byte(&lidar, (uint8_t)USART1->{data});"
        if survives(f"void USART1_IRQHandler(void) {{ {naive} }}\n", folder, sys.argv[2]) is None:
            sys.exit(f"a handler that reads {data} alone seems to survive: is this check still one?")
    failed, count = False, 0
    for block, handler in handlers():
        count += 1
        wrong = survives(handler, folder, sys.argv[2])
        if wrong:
            failed = True
            print(f"{block}: {wrong.strip()}")
    print(f"{count} handlers tried")
    sys.exit(1 if failed or count < 3 else 0)


main()
