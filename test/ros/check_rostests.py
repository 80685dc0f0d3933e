#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_rostests.py "FILE.test ARG:=VALUE ..." ...: whether each of these rostests writes its results to a file of its own.

rostest names that file by the test-name alone: where two have the same, the one that starts removes what the other has just
written.
"""
import os
import sys
import tempfile

import roslaunch

no_checks = tempfile.TemporaryDirectory()  # of scenes, which sessions read and mesh before their nodes start
os.symlink('/bin/true', no_checks.name + '/rosrun')
os.environ['PATH'] = no_checks.name + ':' + os.environ['PATH']
tests = {}
for rostest in sys.argv[1:]:
    file, *arguments = rostest.split()
    for test in roslaunch.config.load_config_default([(file, arguments)], None).tests:
        tests.setdefault(test.test_name, []).append(rostest)
shared = {name: rostests for name, rostests in tests.items() if len(rostests) > 1}
for name, rostests in shared.items():
    print(f"test-name '{name}' is shared by: " + "; ".join(rostests))
sys.exit(len(shared) > 0 or not tests)
