#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which parts of a scene go with which solvers and programs: a small bar with each part, by each of them, against the
table in config/README.md. Without options only what the table says is refused."""
import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile

BAR = {
    "body": "body: {solid: {box: {size_m: [0.02, 0.02, 0.06], center_m: [0, 0, -0.03]}}, element_size_m: 0.03, "
            "material: {youngs_modulus_pa: 264200, poissons_ratio: 0.45, density_kg_m3: 1070}, "
            "fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]}",
    "cables": "cables: [{name: pull, points_m: [[0.006, 0, 0], [0.006, 0, -0.02], [0.006, 0, -0.04], "
              "[0.006, 0, -0.055]], via_points: given}]",
    "markers": "markers: [{name: tip, position_m: [0, 0, -0.06]}]",
    "gravity": "gravity_m_s2: [0, 0, -9.81]",
}
HOLLOW = ("body: {solid: {difference: [{box: {size_m: [0.03, 0.03, 0.06], center_m: [0, 0, -0.03]}}, {name: hollow, "
          "box: {size_m: [0.014, 0.014, 0.03], center_m: [0, 0, -0.03]}}]}, element_size_m: 0.03, "
          "fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]}")
LAYERS = ("body: {solid: {union: [{box: {size_m: [0.02, 0.02, 0.06], center_m: [0, 0, -0.03]}}, {name: sheet, box: "
          "{size_m: [0.004, 0.02, 0.06], center_m: [-0.008, 0, -0.03]}, material: {youngs_modulus_pa: 1.0e+6, "
          "poissons_ratio: 0.45}}]}, element_size_m: 0.03, material: {preset: ecoflex_00_50}, "
          "fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]}")
SECOND = ("bodies: [{name: second, solid: {box: {size_m: [0.02, 0.02, 0.06], center_m: [0.05, 0, -0.03]}}, "
          "element_size_m: 0.03, fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]}]")
BALL = "{name: ball, sphere: {center_m: [0.028, 0, -0.05], radius_m: 0.014}%s}"

# A cube of unit size, for obstacles from meshes.
CUBE = "".join("v %g %g %g\n" % (x, y, z) for z in (-0.5, 0.5) for x, y in
               ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))) + \
    "".join("f %s\n" % face for face in ("4 3 2 1", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"))


def body_with(more):
    return BAR["body"][:-1] + ", " + more + "}"


def cable_with(more):
    return BAR["cables"].replace("via_points: given", "via_points: given, " + more)


def chamber(more):
    return {"body": HOLLOW, "cables": "chambers: [{name: pull, surface: hollow, %s}]" % more}


def obstacle(more="", rest=""):
    return {"contact": "contact: {%sobstacles: [%s]}" % (rest, BALL % more)}


# name: what differs from the bar, and a command of its actuator.
PARTS = {
    "neo-Hookean silicone, sliding cable": ({}, 0.95),
    "Mooney-Rivlin silicone": ({"body": BAR["body"].replace(
        "youngs_modulus_pa: 264200", "model: mooney_rivlin, c10_pa: 30000, c01_pa: 14000")}, 0.95),
    "Yeoh silicone, `preset`": ({"body": re.sub(r"material: {[^}]*}", "material: {preset: ecoflex_00_50}",
                                                BAR["body"])}, 0.95),
    "`regions`, several materials": ({"body": LAYERS}, 0.95),
    "`element: linear`": ({"body": body_with("element: linear")}, 0.95),
    "`linear_volume: vertex_averaged`": ({"body": body_with("element: linear, linear_volume: vertex_averaged")}, 0.95),
    "several `bodies`": ({"bodies": SECOND}, 0.95),
    "cable of `tension_n`": ({"cables": cable_with("command: tension_n")}, 0.2),
    "cable with friction": ({"cables": cable_with("model: friction, friction_coefficient: 0.2")}, 0.95),
    "cable of springs and dampers": ({"cables": cable_with(
        "model: springs, stiffness_n_m: 2000, damping_n_s_m: 1")}, 0.95),
    "cable of explicit springs": ({"cables": cable_with(
        "model: springs, stiffness_n_m: 500, integration: explicit")}, 0.95),
    "cable `around` an obstacle": ({
        "cables": "cables: [{name: pull, drive_points_m: [[0.04, 0, 0.02]], points_m: [[0.006, 0, 0], "
                  "[0.006, 0, -0.03], [0.006, 0, -0.055]], via_points: given, around: [pulley]}]",
        "contact": "contact: {obstacles: [{name: pulley, cylinder: {start_m: [0.02, -0.02, 0.01], "
                   "end_m: [0.02, 0.02, 0.01], radius_m: 0.004}}]}"}, 0.97),
    "chamber of `beta`": (chamber("command: beta"), 1.05),
    "chamber of `syringe`": (chamber("command: syringe, syringe_volume_ml: 20"), 1.0),
    "chamber of `volume_offset`": (chamber("command: volume_offset"), 0.5),
    "chamber of `gauge_pressure`": (chamber("command: gauge_pressure, flow_ml_s: 50"), 1000.0),
    "chamber, `explicit`": (chamber("command: beta, model: explicit"), 1.05),
    "`contact.self`": ({"contact": "contact: {self: true}"}, 0.95),
    "skin that rubs on skin": ({"contact": "contact: {self: true, friction: 0.3}"}, 0.95),
    "fixed obstacle": (obstacle(), 0.95),
    "obstacle with friction": (obstacle("", "friction: 0.3, "), 0.95),
    "obstacle that moves": (obstacle(", motion: [{time_s: 0}, {time_s: 0.1, translation_m: [-0.003, 0, 0]}]"), 1.0),
    "free obstacle": ({"contact": "contact: {friction: 0.3, obstacles: [{name: floor, plane: {point_m: [0, 0, -0.08], "
                                  "normal: [0, 0, 1]}}, {name: block, box: {center_m: [0.03, 0, -0.075], "
                                  "size_m: [0.01, 0.01, 0.01]}, mass_kg: 0.01}]}"}, 0.95),
    "obstacle of a `mesh`": ({"contact": "contact: {friction: 0.3, obstacles: [{name: block, mesh: cube.obj, "
                                         "scale: 0.028, position_m: [0.0281, 0, -0.05]}]}"}, 0.95),
    "free obstacle of a `mesh`": ({"contact": "contact: {friction: 0.3, obstacles: [{name: floor, mesh: cube.obj, "
                                              "scale: 0.04, position_m: [0.04, 0, -0.1]}, {name: block, mesh: cube.obj, "
                                              "scale: 0.01, position_m: [0.03, 0, -0.075], density_kg_m3: 10000}]}"}, 0.95),
    "`rayleigh_mass_per_s`": ({"body": body_with("damping: {rayleigh_mass_per_s: 2}")}, 0.95),
    "`rayleigh_stiffness_s`": ({"body": body_with("damping: {rayleigh_stiffness_s: 0.01}")}, 0.95),
    "hysteresis": ({"body": body_with("hysteresis: {stiffness_ratio: 0.2, relaxation_time_s: 1}")}, 0.95),
    "`fibres`": ({"fibres": "fibres: [{name: thread, axial_stiffness_n: 20, points_m: [[-0.006, 0, -0.005], "
                            "[-0.006, 0, -0.055]]}, {name: wound, axial_stiffness_n: 20, winding: {start_m: [0, 0, -0.01], "
                            "end_m: [0, 0, -0.05], radius_m: 0.007, pitch_m: 0.01}}]"}, 0.95),
    "loads": ({"loads": "loads: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.0599]}, force_n: [0.02, 0, 0]}, "
                        "{marker: tip, mass_kg: 0.002}]"}, 0.95),
    "held end that moves": ({"body": BAR["body"].replace(
        "max_m: [1, 1, 1]}}]", "max_m: [1, 1, 1]}, motion: [{time_s: 0}, {time_s: 0.1, rotation_rad: [0, 0.1, 0]}]}]")},
        1.0),
    "integrator `bdf2`": ({"solver": "solver: {integrator: bdf2}"}, 0.95),
    "integrator `tr_bdf2`": ({"solver": "solver: {integrator: tr_bdf2}"}, 0.95),
}
REST, MOTION = "run: {mode: equilibrium%s, commands: [{time_s: 0, pull: %g}]}", \
    "run: {mode: dynamic, duration_s: 0.1, commands: [{time_s: 0, pull: %g}]}"


def solver(parts, keys):
    stated = parts.get("solver", "solver: {}")
    inner = stated[len("solver: {"):-1]
    return "solver: {" + ", ".join(filter(None, [keys, inner])) + "}"


def training(parts, command):
    """A range of commands with the rest command in it."""
    rest = 0.0 if re.search("tension_n|syringe|volume_offset|gauge_pressure", parts.get("cables", "")) else 1.0
    ends = sorted([rest, command if command != rest else 0.96])
    return "method: reduced, tolerance_m: 2.0e-4, commands: {pull: [%g, %g]}" % tuple(ends)


def scene(parts, run, **more):
    lines = {**BAR, **parts, **more}
    return "\n".join([*lines.values(), run]) + "\n"


class Program:
    """Runs a program on a scene; what it says where it refuses, else nothing."""

    def __init__(self, programs, folder):
        self.programs, self.folder = programs, folder
        with open(os.path.join(folder, "cube.obj"), "w") as file:
            file.write(CUBE)

    def __call__(self, text, program, *arguments, works=(0,)):
        path = os.path.join(self.folder, "scene.yaml")
        with open(path, "w") as file:
            file.write(text)
        done = subprocess.run([os.path.join(self.programs, program), path, "--result", "result.json", *arguments],
                              capture_output=True, text=True, cwd=self.folder, timeout=120)
        if done.returncode in works:
            return ""
        last = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()][-1:]
        words = re.sub(r"^\S+: ", "", "".join(last)).replace("%s:1: " % path, "").replace(path, "FILE")
        return re.sub(r"^FILE:\d*:? ?", "", words) or "status %d" % done.returncode

    def result(self):
        with open(os.path.join(self.folder, "result.json")) as file:
            return json.load(file)


def columns(parts, command):
    """Of each solver and program: what runs there."""
    rest, motion = REST % ("", command), MOTION % command
    xpbd = {**parts, "solver": solver(parts, "method: xpbd")}
    reduced = {**parts, "solver": solver(parts, training(parts, command))}
    low, high = re.search(r"pull: \[(\S+), (\S+)\]", reduced["solver"]).groups()
    free = scene(parts, rest, fidelity="fidelity: {tolerance_m: 0.002}").replace(", element_size_m: 0.03", "")
    aim = ("--marker", "tip", "--target", "0.004", "0", "-0.0595", "--iterations", "3")
    return {
        "newton, rest": (scene(parts, rest), "simulate"),
        "newton, time": (scene(parts, motion), "simulate"),
        "xpbd, rest": (scene(xpbd, rest), "simulate"),
        "xpbd, time": (scene(xpbd, motion), "simulate"),
        "reduced, rest": (scene(reduced, rest), "simulate"),
        "reduced, time": (scene(reduced, motion), "simulate"),
        "sensitivity": (scene(parts, REST % (", sensitivity: true", command)), "simulate"),
        "modal": (scene(parts, "run: {mode: modal}"), "simulate"),
        "fidelity": (free, "simulate"),
        "optimise": (scene(parts, ""), "optimise", *aim),
        "rollouts": (scene(parts, ""), "rollouts", "--random", "2", "--duration", "0.1", "--range", "pull", low, high),
        "check_casting": (scene(parts, ""), "check_casting"),
    }


WITHIN_M = {"xpbd, rest": 1e-4, "reduced, rest": 1e-4, "fidelity": 2e-3}  # of where newton rests


def words_of(program, parts, command, asked):
    """Of the asked columns what refuses there; the tip must rest where it does by newton."""
    found, rests_m = {}, None
    for column, (text, name, *arguments) in columns(parts, command).items():
        if column not in asked:
            continue
        found[column] = program(text, name, *arguments, works=(0, 1) if name == "check_casting" else (0,))
        if found[column] or not (column == "newton, rest" or column in WITHIN_M):
            continue
        tip_m = program.result()["markers"]["tip"]["position_m"]
        rests_m = rests_m or tip_m
        if math.dist(tip_m, rests_m) > WITHIN_M.get(column, 0.0):
            found[column] = "rests %.3g mm from where it does by newton" % (1e3 * math.dist(tip_m, rests_m))
    return found


FIRST, LAST = "<!-- combinations -->\n", "<!-- end of combinations -->"


def table_of(found):
    """The table in Markdown, and what the numbers in it say."""
    names = list(columns({}, 0.95))
    notes, rows = [], []
    for part, cells in found.items():
        row = [part]
        for words in cells.values():
            if words and words not in notes:
                notes.append(words)
            row.append("[%d]" % (notes.index(words) + 1) if words else "yes")
        rows.append("| " + " | ".join(row) + " |")
    head = ["| part | " + " | ".join(names) + " |", "|" + "---|" * (len(names) + 1)]
    return "\n".join(head + rows + [""] + ["%d. `%s`" % (i + 1, note) for i, note in enumerate(notes)]) + "\n"


def table_in(text):
    """What a README's table says: part: column: words, empty where it works."""
    inner = text[text.index(FIRST) + len(FIRST):text.index(LAST)]
    lines = inner.strip().splitlines()
    notes = {number: words for number, words in re.findall(r"^(\d+)\. `(.*)`$", inner, re.M)}
    names = [cell.strip() for cell in lines[0].split("|")[2:-1]]
    found = {}
    for line in lines[2:]:
        if not line.startswith("|"):
            break
        part, *cells = [cell.strip() for cell in line.split("|")[1:-1]]
        found[part] = {name: "" if cell == "yes" else notes[cell.strip("[]")] for name, cell in zip(names, cells)}
    return found


def compare(program, stated, whole):
    """Differences between what the table says and what happens; of what works only where `whole`."""
    wrong = []
    for part, (parts, command) in PARTS.items():
        said = stated.get(part, {})
        asked = [column for column in columns(parts, command) if whole or said.get(column) != ""]
        for column, found in words_of(program, parts, command, asked).items():
            if found != said.get(column):
                wrong.append("%s by %s: %r in the table, %r by the program" % (part, column, said.get(column), found))
    return wrong + ["%s: not run" % part for part in stated if part not in PARTS]


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("programs", help="the folder of simulate")
    arguments.add_argument("readme")
    arguments.add_argument("--write", action="store_true", help="the table anew")
    arguments.add_argument("--whole", action="store_true", help="also what the table says works")
    asked = arguments.parse_args()
    with open(asked.readme) as file:
        text = file.read()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        program = Program(os.path.abspath(asked.programs), folder)
        if asked.write:
            found = {part: words_of(program, *of, columns(*of)) for part, of in PARTS.items()}
            text = text[:text.index(FIRST) + len(FIRST)] + table_of(found) + text[text.index(LAST):]
            with open(asked.readme, "w") as file:
                file.write(text)
            return 0
        wrong = compare(program, table_in(text), asked.whole)
    print("\n".join(wrong) or "as the table says")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
