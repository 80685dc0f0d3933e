#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_includes.py ROOT: every part includes only the parts that its row names, only ros/ and programs/ know ROS, and installed
headers include no others of ours. Lists each offending line and ends with 1."""
import pathlib
import posixpath
import re
import sys

PERCEPTION = "perception/tracking perception/calibration perception/render"
HARDWARE = "hardware/motor hardware/testbench hardware/plant"
BODY = "mechanics/mesh mechanics/material mechanics/body mechanics/state"
TERMS = f"mechanics mechanics/linear_algebra mechanics/complementarity {BODY} mechanics/elements mechanics/contact settings"
MODEL = f"{BODY} mechanics/simulation"  # what other parts know of mechanics: no term and no solver
ROBOT = f"robot/casting robot/design robot/scene robot/rollouts {MODEL} mechanics/actuators mechanics/reduced geometry settings"
PRODUCT = (f"session session/report control control/motion control/identification control/estimation {HARDWARE} {PERCEPTION}"
           f" {ROBOT}")
ROS_BASE = "ros/base ros/messages"
ROS_ROOMS = f"{ROS_BASE} ros/tracking ros/cameras ros/recording ros/display ros/simulator ros/controller"
ALLOWED = {  # a row names only rows above it, so no circle can be written
    "settings": "",
    "geometry": "",
    "mechanics": "",  # solver_constants.h
    "mechanics/linear_algebra": "mechanics settings",
    "mechanics/mesh": "mechanics settings",
    "mechanics/material": "mechanics mechanics/linear_algebra settings",
    "mechanics/body": "mechanics mechanics/mesh mechanics/material settings",
    "mechanics/state": "mechanics mechanics/mesh mechanics/body settings",
    "mechanics/complementarity": "mechanics mechanics/linear_algebra mechanics/state settings",
    "mechanics/elements": f"mechanics mechanics/linear_algebra {BODY} settings",
    "mechanics/contact": f"mechanics mechanics/linear_algebra {BODY} settings",
    "mechanics/actuators": f"{BODY} settings",
    "mechanics/newton": TERMS,
    "mechanics/xpbd": TERMS,
    "mechanics/simulation": f"mechanics/newton mechanics/xpbd {TERMS}",
    "mechanics/reduced": f"mechanics/simulation mechanics/newton mechanics/actuators {TERMS}",
    "robot/design": "settings",
    "robot/scene": f"robot/design {MODEL} mechanics/reduced settings",
    "robot/rollouts": f"robot/scene {MODEL} mechanics/reduced settings",
    "robot/casting": f"geometry robot/scene robot/design {MODEL} settings",
    "perception/tracking": "settings",
    "perception/calibration": "perception/tracking settings",
    "perception/render": "geometry perception/calibration perception/tracking settings",
    "hardware/motor": "settings",
    "hardware/firmware": "hardware/motor",
    "hardware/emulator": "hardware/motor settings",
    "hardware/testbench": "hardware/motor settings",
    "hardware/plant": f"hardware/motor perception/render robot/scene {MODEL} settings",
    "control": f"{MODEL} mechanics/reduced settings",
    "control/motion": f"control {MODEL} settings",
    "control/identification": f"control robot/scene {MODEL} settings",
    "control/estimation": f"control control/identification {MODEL} settings",
    "session": f"control control/motion control/identification control/estimation {MODEL} settings",
    "session/report": f"geometry perception/render robot/design {MODEL} settings",
    "study": f"session/report robot/scene {MODEL} settings",
    "study/sweeps": "session/report robot/scene robot/design settings",
    "study/workspace": f"study/sweeps session/report control {MODEL} geometry settings",
    "study/robust": f"study/sweeps session/report control control/identification robot/scene {MODEL} settings",
    "study/search": f"study/workspace study/sweeps session/report control {ROBOT}",
    "study/experiments": f"study study/search session/report control control/identification {PERCEPTION} {ROBOT}",
    "study/charts": f"study session/report control/identification {ROBOT}",
    "study/rig": f"study study/experiments {PRODUCT}",
    "ros/base": PRODUCT,
    "ros/messages": f"ros/base {PRODUCT}",
    "ros/tracking": f"{ROS_BASE} {PRODUCT}",
    "ros/cameras": f"ros/tracking {ROS_BASE} {PRODUCT}",
    "ros/recording": f"ros/tracking {ROS_BASE} {PRODUCT}",
    "ros/display": f"{ROS_BASE} {PRODUCT}",
    "ros/simulator": f"ros/display {ROS_BASE} {PRODUCT}",
    "ros/controller": f"ros/recording ros/display {ROS_BASE} {PRODUCT}",
    "ros/view": f"ros/display ros/base {PRODUCT}",
    "ros/panel": f"ros/view ros/display {ROS_BASE} {PRODUCT}",
    "ros/report": f"ros/tracking ros/cameras ros/recording ros/display {ROS_BASE} {PRODUCT}",
    "ros/nodes": f"{ROS_ROOMS} {PRODUCT}",
    "python/core": f"study/robust control control/identification {ROBOT}",
    "programs": f"study study/sweeps study/workspace study/robust study/search study/experiments study/charts study/rig"
                f" {ROS_ROOMS} ros/report mechanics/linear_algebra {PRODUCT}",
}
# Installed headers of mechanics stand in one folder; which of its folders each belongs to.
PUBLIC = {
    "mechanics/mesh": "embedding.h tet_mesh.h",
    "mechanics/material": "material.h viscosity.h",
    "mechanics/body": "body.h marker.h obstacle.h",
    "mechanics/state": "actuator.h constraint.h drive_state.h simulation_state.h solve_report.h solver_options.h",
    "mechanics/simulation": "energy_ledger.h model.h simulation.h",
}
FOLDER_OF = {f"mechanics/{name}": folder for folder, names in PUBLIC.items() for name in names.split()}
ROS = re.compile(r"(ros|rosbag|pluginlib|class_loader|nodelet|tf2\w*|roslib|\w*_msgs|std_srvs|diagnostic_updater|message_filters)/"
                 r"|soft_robot_lab/[A-Z]")  # the latter are generated messages
INCLUDE = re.compile(r'\s*#\s*include\s*([<"])([^">]+)[">]')


def part_of(path):
    """The longest row that this path, below src/ or include/soft_robot_lab/, lies in; None for none."""
    return FOLDER_OF.get(path) or next((str(folder) for folder in pathlib.PurePath(path).parents if str(folder) in ALLOWED), None)


def below_root(folder, quote, included):
    """What an include names, below src/ or include/soft_robot_lab/."""
    if quote == '"' and (included.startswith(".") or "/" not in included):
        return posixpath.normpath(f"{folder}/{included}")
    return included.removeprefix("soft_robot_lab/")


def offences(file, quote, included):
    path = file.as_posix()
    installed = path.startswith("include/")
    inside = path.split("/", 2 if installed else 1)[-1]
    part = part_of(inside)
    if part is None or (installed and part == "mechanics"):
        yield "lies in no part"
        return
    if included.startswith("gmsh") and not path.startswith("src/programs/mesh"):
        yield "Gmsh is GPL: only the program mesh_robot may include it"
    if included.startswith("simavr/") and part != "hardware/emulator":
        yield "simavr is GPL: only the program rig_emulator may include it"
    other = part_of(below_root(posixpath.dirname(inside), quote, included))
    if other is None and ROS.match(included):
        if part != "programs" and not part.startswith("ros/"):
            yield f"{part}/ may not know ROS"
        return
    if quote == '"' and installed and "/" in included and not included.startswith("soft_robot_lab/"):
        yield "an installed header may include only installed ones"
    if other not in (None, part, *ALLOWED[part].split()):
        yield f"{part}/ may include only {ALLOWED[part] or 'itself'}"


def main(root):
    rows = list(ALLOWED)
    found = False
    for part, row in ALLOWED.items():
        for other in set(row.split()) - set(rows[:rows.index(part)]):
            print(f"{part}: its row names {other}, which does not stand above it")
            found = True
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
