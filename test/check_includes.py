#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_includes.py ROOT: every part includes only the parts that its row names, only ros/ and programs/ know ROS, and installed
headers include no others of ours. Lists each offending line and ends with 1."""
import pathlib
import re
import sys

PERCEPTION = "perception/tracking perception/calibration perception/render"
HARDWARE = "hardware/motor hardware/testbench hardware/plant"
ROBOT = "robot/casting robot/design robot/scene robot/rollouts mechanics mechanics/actuators mechanics/reduced geometry settings"
PRODUCT = f"session session/report control control/identification {HARDWARE} {PERCEPTION} {ROBOT}"
ALLOWED = {
    "settings": "",
    "geometry": "",
    "mechanics": "settings",
    "mechanics/actuators": "mechanics settings",
    "mechanics/reduced": "mechanics mechanics/actuators settings",
    "robot/design": "settings",
    "robot/scene": "robot/design mechanics mechanics/reduced settings",
    "robot/rollouts": "robot/scene mechanics mechanics/reduced settings",
    "robot/casting": "geometry robot/scene robot/design mechanics settings",
    "perception/tracking": "settings",
    "perception/calibration": "perception/tracking settings",
    "perception/render": "geometry perception/calibration perception/tracking settings",
    "hardware/motor": "settings",
    "hardware/firmware": "hardware/motor",
    "hardware/emulator": "hardware/motor settings",
    "hardware/testbench": "hardware/motor settings",
    "hardware/plant": "hardware/motor perception/render robot/scene mechanics settings",
    "control": "mechanics mechanics/reduced settings",
    "control/identification": "control robot/scene mechanics settings",
    "session": "control control/identification mechanics settings",
    "session/report": "geometry perception/render robot/design mechanics settings",
    "study": PRODUCT,
    "ros": PRODUCT,
    "programs": f"study ros {PRODUCT}",
}
ROS = re.compile(r"(ros|rosbag|pluginlib|class_loader|nodelet|tf2\w*|roslib|\w*_msgs|std_srvs|diagnostic_updater|message_filters)/"
                 r"|soft_robot_lab/[A-Z]")  # the latter are generated messages
INCLUDE = re.compile(r'\s*#\s*include\s*([<"])([^">]+)[">]')


def part_of(path):
    """The longest row that this path, below src/ or include/soft_robot_lab/, lies in; None for none."""
    return next((str(folder) for folder in pathlib.PurePath(path).parents if str(folder) in ALLOWED), None)


def offences(file, quote, included):
    path = file.as_posix()
    installed = path.startswith("include/")
    part = part_of(path.split("/", 2 if installed else 1)[-1])
    if part is None:
        yield "lies in no part"
        return
    if included.startswith("gmsh") and not path.startswith("src/programs/mesh"):
        yield "Gmsh is GPL: only the program mesh_robot may include it"
    if included.startswith("simavr/") and part != "hardware/emulator":
        yield "simavr is GPL: only the program rig_emulator may include it"
    if ROS.match(included):
        if part not in ("ros", "programs"):
            yield f"{part}/ may not know ROS"
        return
    if quote == '"' and installed and "/" in included and not included.startswith("soft_robot_lab/"):
        yield "an installed header may include only installed ones"
    other = part_of(included.removeprefix("soft_robot_lab/"))
    if other not in (None, part, *ALLOWED[part].split()):
        yield f"{part}/ may include only {ALLOWED[part] or 'itself'}"


def main(root):
    found = False
    for folder in ("src", "include"):
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in (".h", ".cpp"):
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                match = INCLUDE.match(line)
                for why in offences(file.relative_to(root), *match.groups()) if match else ():
                    print(f"{file.relative_to(root)}:{number}: {line.strip()}: {why}")
                    found = True
    return 1 if found else 0


sys.exit(main(pathlib.Path(sys.argv[1])))
