#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""free_port.py [COUNT]: prints a free port, or so many, for servers that will be started: none of those that Linux hands
out by itself (from 32768 on), or another program may have it by then. Programs that ask at the same time get different
ones."""
import argparse
import os
import socket
import sys

FIRST, COUNT = 11400, 20000

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument('count', metavar='COUNT', nargs='?', type=int, default=1, choices=range(1, 101), help='1 to 100 (1)')
wanted = parser.parse_args().count
free = []
for ahead in range(COUNT):
    port = FIRST + (os.getppid() + ahead) % COUNT
    with socket.socket() as trial:
        try:
            trial.bind(("", port))
        except OSError:
            continue
    free.append(port)
    if len(free) == wanted:
        print(*free)
        sys.exit()
sys.exit(f"no {wanted} ports from {FIRST} to {FIRST + COUNT - 1} are free")
