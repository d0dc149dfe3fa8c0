# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Measures the Python package's processor time: for an hour's recording, and while a lidar scans.

It starts itself in a separate process: python_package.py RECORDING
"""

import os
import socket
import sys
import time

BYTES_PER_SECOND = 13_100  # Section 1 of the protocol.
SCANNING_S = 5


def measure(folder, clean):
    """Installs the package; returns {"hour": seconds, "percent": of one core}."""
    from targets import ROOT, run  # pylint: disable=import-outside-toplevel
    python = ROOT / "build" / "test" / "python" / "venv" / "bin" / "python"
    recording = folder / "hour.bin"
    recording.write_bytes(clean * (3600 * BYTES_PER_SECOND // len(clean) + 1))
    run(python, "-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps",
        "--no-build-isolation", ROOT / "port" / "python")
    hour, percent = run(python, __file__, recording).split()
    recording.unlink()
    return {"hour": float(hour), "percent": float(percent)}


def seconds_to_read(path):
    """The processor time for reading a recording, with all arrays of each scan."""
    begun = time.process_time()
    for scan in tmini.read(path):
        assert len(scan.angles_rad) == len(scan.ranges_m) == len(scan.times_s)
    return time.process_time() - begun


def send(server, content):
    """Sends bytes as a scanning lidar does, in a separate process, so that its time is not counted."""
    connection, _ = server.accept()
    begun = time.monotonic()
    try:
        for at in range(0, len(content), 131):
            connection.sendall(content[at:at + 131])
            time.sleep(max(0, begun + at / BYTES_PER_SECOND - time.monotonic()))
    except OSError:
        pass  # The receiver has enough and has closed the connection.


def percent_of_scanning(content):
    server = socket.create_server(("127.0.0.1", 0))
    if os.fork() == 0:
        send(server, content)
        os._exit(0)
    with tmini.Lidar(f"tcp:127.0.0.1:{server.getsockname()[1]}", listen_only=True) as lidar:
        begun, used = time.monotonic(), time.process_time()
        while time.monotonic() < begun + SCANNING_S:
            assert lidar.read(1) is not None
        return 100 * (time.process_time() - used) / (time.monotonic() - begun)


if __name__ == "__main__":
    import tmini
    with open(sys.argv[1], "rb") as file:
        print(seconds_to_read(sys.argv[1]), percent_of_scanning(file.read(20 * BYTES_PER_SECOND)))
