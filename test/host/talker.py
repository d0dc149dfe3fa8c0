# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A pseudo-terminal with something else than a lidar.

    talker.py BYTES CODE

Prints the port. Sends the bytes (in hexadecimal; "-": none) again and again, at about the lidar's speed; with a CODE
other than 0 once after each command A5 CODE.
"""

import os
import pty
import select
import sys
import tty

STEP_MS = 10
STEP_BYTES = 131

content = b"" if sys.argv[1] == "-" else bytes.fromhex(sys.argv[1])
code = int(sys.argv[2])
master, line = pty.openpty()  # The line stays open: otherwise there would be a hang-up.
tty.setraw(line)
os.set_blocking(master, False)
print(os.ttyname(line), flush=True)
commands = select.poll()
commands.register(master, select.POLLIN)
heard, at = b"", 0
while True:
    if commands.poll(STEP_MS):
        heard = heard[-1:] + os.read(master, 100)
        for _ in range(heard.count(bytes([0xA5, code])) if code else 0):
            os.write(master, content)
    elif content and code == 0:
        try:
            at += os.write(master, (content * 2)[at:at + STEP_BYTES] if len(content) >= STEP_BYTES else content)
        except BlockingIOError:  # Nobody reads.
            pass
        at %= len(content)
