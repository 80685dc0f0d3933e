#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_rosdep.py ROOT [PACKAGE.xml]: every dependency in package.xml is a ROS package, a key of rosdep's own list, or one that
config/rosdep.yaml names; and what that names is used and installed. Lists what is not, and ends with 1."""
import pathlib
import re
import sys

import yaml

# Of rosdep's base.yaml and python.yaml, for Debian bookworm.
ROSDEPS_OWN = set("""avr-libc benchmark boost bullet bzip2 cli11 doxygen eigen gcc-avr gnuplot gtest libceres-dev libopenblas-dev
libopencv-dev libpcl-all-dev libqwt-qt5-dev mpi nlohmann-json-dev pybind11-dev python3-dev python3-numpy qtbase5-dev sqlite3 yaml-cpp""".split())


def offences(root, package):
    keys = set(re.findall(r"<[a-z_]*depend>([^<]+)</", package.read_text()))
    ours = yaml.safe_load((root / "config/rosdep.yaml").read_text())
    installed = (root / "launch/install_dependencies.sh").read_text().split()
    for key in sorted(keys - ROSDEPS_OWN - set(ours)):
        if not pathlib.Path(f"/usr/share/{key}/package.xml").exists():
            yield f"{package}: rosdep knows no key '{key}', and config/rosdep.yaml does not name it"
    for key, packages in ours.items():
        if key not in keys:
            yield f"config/rosdep.yaml: nothing depends on '{key}'"
        for name in packages["debian"]:
            if name not in installed:
                yield f"config/rosdep.yaml: install_dependencies.sh does not install {name}"


def main():
    root = pathlib.Path(sys.argv[1])
    package = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else root / "package.xml"
    found = list(offences(root, package))
    print("\n".join(found) if found else "all keys are known")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
