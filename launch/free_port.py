#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints a free port for a ROS master that will be started: none of those that Linux hands out by itself (from 32768
on), or another program may have it by then. Programs that ask at the same time get different ones."""
import os
import socket
import sys

FIRST, COUNT = 11400, 20000

for ahead in range(COUNT):
    port = FIRST + (os.getppid() + ahead) % COUNT
    with socket.socket() as trial:
        try:
            trial.bind(("", port))
        except OSError:
            continue
    print(port)
    sys.exit()
sys.exit(f"no port from {FIRST} to {FIRST + COUNT - 1} is free")
