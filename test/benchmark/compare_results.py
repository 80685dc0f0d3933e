#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the results of two builds' `simulate` to the last digit, for changes that must leave all numbers alone.

Every scene and robot of config/ runs at rest, in time by each method and integrator, and with each model of its
actuators (friction, springs, explicit, regulated) and of its material (damping, hysteresis). Not run by ctest.

    test/benchmark/compare_results.py BEFORE AFTER [--only TEXT] [--keep FOLDER] [--seconds N] [--fine]

BEFORE, AFTER   programs `simulate`, or scripts that start them (as where a build's libraries are found by
                LD_LIBRARY_PATH)
--only TEXT     cases whose name contains it; a name is FILE/CASE, as in robots/spinebot/robot/friction_dynamic
--keep FOLDER   keeps the results there; those of BEFORE are taken from there where they exist
--seconds N     a case that takes BEFORE more CPU time is left out (default 20)
--fine          robots on their fine meshes too

Ends with 0 where all results are equal, 1 where one differs (its first differences are shown), 2 on bad arguments.
Results hold 17 digits, so equal texts are equal numbers. The time that a run took is not compared.
"""
import argparse
import glob
import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile

import yaml

CONFIG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "config")
STEP_S = 0.0166667


def with_includes(path):
    """A scene's top level, for the names and commands of its actuators."""
    with open(path) as file:
        scene = yaml.safe_load(file)
    if "include" not in scene:
        return scene
    return {**with_includes(os.path.join(os.path.dirname(path), scene["include"])), **scene}


def pulled(actuator, share):
    """A command between rest (share 0) and a large one (1)."""
    kind = actuator.get("command", "contraction" if "points_m" in actuator else "beta")
    largest = {"contraction": 0.85, "tension_n": 2.0, "beta": 1.4, "syringe": 20.0, "volume_offset": 0.3,
               "gauge_pressure": 5000.0}[kind]
    rest = 1.0 if kind in ("contraction", "beta") else 0.0
    return rest + share * (largest - rest)


def commands(actuators, time_s, shares):
    return {"time_s": time_s, **{a["name"]: pulled(a, share) for a, share in zip(actuators, shares)}}


def at_rest(actuators):
    steps = [[0.3, 0.0, 0.1], [0.6, 0.3, 0.0], [0.2, 0.6, 0.5], [1.0, 0.0, 0.2]]
    return {"mode": "equilibrium", "sensitivity": bool(actuators),
            "commands": [commands(actuators, i, shares) for i, shares in enumerate(steps)]}


def in_time(actuators, duration_s):
    return {"mode": "dynamic", "duration_s": duration_s,
            "commands": [commands(actuators, 0.0, [0.5, 0.0, 0.2]),
                         commands(actuators, 0.4 * duration_s, [0.2, 0.7, 0.2])]}


def changed(kind, actuators, changes):
    return {kind: {a["name"]: changes for a in actuators}}


def cases(path):
    """Name and what is laid over the file, of all that can be asked of it."""
    scene = with_includes(path)
    cables, chambers = scene.get("cables", []), scene.get("chambers", [])
    actuators = cables + chambers
    rest, short, long = at_rest(actuators), in_time(actuators, 0.1), in_time(actuators, 0.25)
    newton = {"method": "newton", "time_step_s": STEP_S}
    yield "as_it_is", {}
    yield "rest", {"run": rest}
    yield "euler", {"run": long, "solver": {**newton, "integrator": "implicit_euler"}}
    yield "bdf2", {"run": long, "solver": {**newton, "integrator": "bdf2"}}
    yield "substeps", {"run": short, "solver": {"method": "xpbd", "time_step_s": STEP_S}}
    yield "linear", {"run": long, "body": {"element": "linear"}}
    yield "damped", {"run": long, "body": {"damping": {"rayleigh_mass_per_s": 2.0, "rayleigh_stiffness_s": 0.002}}}
    yield "hysteresis", {"run": long, "body": {"hysteresis": {"stiffness_ratio": 0.2, "relaxation_time_s": 0.1}}}
    if cables and cables[0].get("command", "contraction") == "contraction":
        friction = changed("cables", cables, {"model": "friction", "friction_coefficient": 0.3})
        springs = {"model": "springs", "stiffness_n_m": 2000, "damping_n_s_m": 2}
        springs = [{key: value for key, value in {**cable, **springs}.items() if key != "compliance_m_n"}
                   for cable in cables]
        explicit = [{**cable, "stiffness_n_m": 200, "integration": "explicit"} for cable in springs]
        yield "friction_rest", {"run": rest, **friction}
        yield "friction_dynamic", {"run": long, **friction}
        yield "springs_rest", {"run": rest, "cables": springs}
        yield "springs_dynamic", {"run": long, "cables": springs}
        yield "explicit_dynamic", {"run": long, "cables": explicit}
        yield "explicit_substeps", {"run": short, "cables": explicit, "solver": {"method": "xpbd"}}
        yield "delayed", {"run": long, **changed("cables", cables, {"pull_speed_m_s": 0.01, "pull_delay_s": 0.05})}
    if chambers:
        regulated = [{"name": a["name"], "surface": a["surface"], "command": "gauge_pressure", "flow_ml_s": 5}
                     for a in chambers]
        offset = [{"name": a["name"], "surface": a["surface"], "command": "volume_offset"} for a in chambers]
        yield "explicit_dynamic", {"run": long, **changed("chambers", chambers, {"model": "explicit"})}
        yield "explicit_substeps", {"run": short, **changed("chambers", chambers, {"model": "explicit"}),
                                    "solver": {"method": "xpbd"}}
        yield "regulated_rest", {"run": at_rest(regulated), "chambers": regulated}
        yield "regulated_dynamic", {"run": in_time(regulated, 0.25), "chambers": regulated}
        yield "offset_rest", {"run": at_rest(offset), "chambers": offset}


def run(program, scene, seconds):
    """The result as a map without times, or what came in its place; None where it took too long."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run([program, scene], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds)))
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return None
    try:
        result = json.loads(done.stdout)
        result.get("solver", {}).pop("wall_s", None)
    except ValueError:
        result = {"stdout": done.stdout}
    return {"exit": done.returncode, "stderr": re.sub(r"simulate: \d+ %.*\n", "", done.stderr).replace(scene, "SCENE"), "result": result}


def differences(a, b, place=""):
    if isinstance(a, dict) and isinstance(b, dict):
        for key in sorted(set(a) | set(b)):
            yield from differences(a.get(key), b.get(key), f"{place}.{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for i, (x, y) in enumerate(zip(a, b)):
            yield from differences(x, y, f"{place}[{i}]")
    elif a != b:
        yield f"{place}: {a!r} -> {b!r}"


def read(path):
    with open(path) as file:
        return json.load(file)


def result_of(program, side, name, scene, arguments):
    kept = arguments.keep and os.path.join(arguments.keep, side, name.replace("/", ".") + ".json")
    if kept and side == "before" and os.path.exists(kept):
        return read(kept)
    result = run(program, scene, arguments.seconds if side == "before" else 4 * arguments.seconds)
    if kept:
        os.makedirs(os.path.dirname(kept), exist_ok=True)
        with open(kept, "w") as file:
            json.dump(result, file, indent=1)
    return result


def compare(path, arguments, counts):
    stem = os.path.splitext(os.path.relpath(path, CONFIG))[0]
    for case, overlay in cases(path):
        name = f"{stem}/{case}"
        if arguments.only not in name:
            continue
        with tempfile.TemporaryDirectory() as folder:
            scene = os.path.join(folder, "scene.yaml")
            with open(scene, "w") as file:
                yaml.safe_dump({"include": os.path.abspath(path), **overlay}, file)
            before = result_of(arguments.before, "before", name, scene, arguments)
            after = before and result_of(arguments.after, "after", name, scene, arguments)
        different = list(differences(before, after)) if before else []
        word = "too long" if before is None else "DIFFERS" if different else \
            "equal" if before["exit"] != 2 else "refused by both"
        counts[word] = counts.get(word, 0) + 1
        print(f"{word:16}{name}", flush=True)
        for text in different[:5]:
            print(f"    {text[:200]}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("--only", default="")
    parser.add_argument("--keep")
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--fine", action="store_true")
    arguments = parser.parse_args()
    counts = {}
    for path in sorted(glob.glob(os.path.join(CONFIG, "scenes", "*.yaml")) +
                       glob.glob(os.path.join(CONFIG, "robots", "*", "robot.yaml")) +
                       glob.glob(os.path.join(CONFIG, "robots", "*", "fine.yaml"))):
        if arguments.fine or not path.endswith("fine.yaml"):
            compare(path, arguments, counts)
    print(", ".join(f"{count} {word}" for word, count in sorted(counts.items())))
    return 1 if counts.get("DIFFERS") else 0


if __name__ == "__main__":
    sys.exit(main())
