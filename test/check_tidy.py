#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy with the checks of .clang-tidy.

    test/check_tidy.py BUILD [--root FOLDER] [--sources] [--only TEXT] [--jobs N] [--clang-tidy PROGRAM]

BUILD                 folder of a build, with compile_commands.json
--root FOLDER         that has src/ and include/soft_robot_lab/ (default this package)
--sources             all of src/, as it is compiled; otherwise all headers
--only TEXT           folders and files whose name contains it
--jobs N              programs at a time (default 2)
--clang-tidy PROGRAM  default clang-tidy

Headers are read together, so one name may mean one thing only. Batches of sources are read as they are compiled; the
precompiled headers are left out. Ends with 0 where nothing is found, 1 where something is, 2 on bad arguments.
"""
import argparse
import concurrent.futures
import glob
import json
import os
import re
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


class Tree:
    """Our files: src/ and include/soft_robot_lab/ of a folder."""

    def __init__(self, root):
        self.root = os.path.abspath(root)
        self.sources = os.path.join(self.root, "src", "")
        self.public = os.path.join(self.root, "include", "soft_robot_lab", "")

    def headers(self):
        return sorted(glob.glob(f"{self.sources}**/*.h", recursive=True) + glob.glob(f"{self.public}**/*.h", recursive=True))

    def group_of(self, file):
        """Groups are read at once, as most of their time goes into other people's headers."""
        top = self.public if file.startswith(self.public) else self.sources
        part = os.path.relpath(file, top).split(os.sep)[0]
        return part if part in ("ros", "programs", "hardware") else "cores"


def sources_of(file):
    """What a batch includes, or the file itself."""
    if "/Unity/" not in file:
        return [file]
    with open(file) as batch:
        return re.findall(r'^#include "(.*)"', batch.read(), re.M)


def compiled(tree, build):
    """The entries of src/ in compile_commands.json, each with its sources."""
    with open(os.path.join(build, "compile_commands.json")) as file:
        for entry in json.load(file):
            entry["sources"] = sources_of(entry["file"])
            if all(source.startswith(tree.sources) and source.endswith(".cpp") for source in entry["sources"]):
                entry["command"] = re.sub(r" -Winvalid-pch| -Xclang -include(-pch)? -Xclang \S+| -include \S+", "",
                                          entry["command"])
                yield entry


def header_units(tree, build, database):
    """A source a group that includes all its headers, with all options that sources of the group have."""
    options, groups = {}, {}
    for entry in compiled(tree, build):
        words = shlex.split(entry["command"].replace("-isystem ", "-isystem"))
        words = [word for word in words if word.startswith(("-D", "-I", "-isystem"))]
        for source in entry["sources"]:
            options.setdefault(tree.group_of(source), {"-std=c++17": None}).update(dict.fromkeys(words))
    for header in tree.headers():
        groups.setdefault(tree.group_of(header), []).append(header)
    for group, headers in groups.items():
        unit = os.path.join(database, f"headers_of_{group}.cpp")
        with open(unit, "w") as file:
            file.writelines(f'#include "{header}"\n' for header in headers)
        beside = [f"-iquote{folder}" for folder in sorted({os.path.dirname(header) for header in headers})]
        command = ["c++", *options[group], *beside, "-c", unit]
        yield {"directory": build, "file": unit, "arguments": command, "sources": headers}


def findings(program, tree, database, file):
    """Its complaints, without the counts of those about other people's headers."""
    command = [program, f"--config-file={ROOT}/.clang-tidy", f"--header-filter=^{tree.root}/(src|include)/",
               "--quiet", "--extra-arg=-w", "-p", database, file]
    done = subprocess.run(command, capture_output=True, text=True)
    text = done.stdout.strip()
    if done.returncode != 0 and not text:
        text = done.stderr.strip()
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--root", default=ROOT)
    parser.add_argument("--sources", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--clang-tidy", default="clang-tidy")
    arguments = parser.parse_args()
    tree, build = Tree(arguments.root), os.path.abspath(arguments.build)
    database = os.path.join(build, "tidy")
    os.makedirs(database, exist_ok=True)
    units = list(compiled(tree, build) if arguments.sources else header_units(tree, build, database))
    units = [unit for unit in units if any(arguments.only in source for source in unit["sources"])]
    if not units:
        parser.error(f"{arguments.build}/compile_commands.json has nothing of {tree.sources}{arguments.only}")
    with open(os.path.join(database, "compile_commands.json"), "w") as file:
        json.dump([{key: unit[key] for key in unit if key != "sources"} for unit in units], file)
    found = 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for text in pool.map(lambda unit: findings(arguments.clang_tidy, tree, database, unit["file"]), units):
            if text:
                found += 1
                print(text, flush=True)
    print(f"{len(units)} units of {len({s for unit in units for s in unit['sources']})} files read, {found} with findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
