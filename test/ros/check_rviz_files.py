#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_rviz_files.py ROOT FOLDER: what rviz files in FOLDER show fits a session of the package in ROOT. Topics are ours, and
relative, so that a session may stand in a namespace; classes of ours exist; and a file shows an image only where its name says so,
as a dock without one says "No Image". Lists what does not hold, and ends with 1."""
import pathlib
import re
import sys

import yaml


def topics_of(root):
    text = (root / "src/ros/base/topics.h").read_text()
    return set(re.findall(r'= "([^"]+)";', text))


def offences(file, topics, classes):
    described = yaml.safe_load(file.read_text())
    displays = described["Visualization Manager"]["Displays"]
    if "soft_robot_lab/Session" not in [panel["Class"] for panel in described["Panels"]]:
        yield "no panel soft_robot_lab/Session"
    for thing in displays + described["Panels"] + described["Visualization Manager"]["Tools"]:
        name = thing.get("Name", thing["Class"])
        if thing["Class"].startswith("soft_robot_lab/") and thing["Class"] not in classes:
            yield f"{name}: no class {thing['Class']} in rviz_plugin_description.xml"
        if thing["Class"] == "rviz/Image" and file.stem == "session":
            yield f"{name}: an image that a simulated session does not have"
        for key in [key for key in thing if key.endswith("Topic")]:
            topic = thing[key].removesuffix("/update")
            if topic.startswith("/"):
                yield f"{name}: {key} {topic} is absolute"
            elif topic not in topics:
                yield f"{name}: nobody publishes {topic}"


def main():
    root, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    topics = topics_of(root)
    classes = set(re.findall(r'class name="([^"]+)"', (root / "config/rviz_plugin_description.xml").read_text()))
    files = sorted(folder.glob("*.rviz"))
    found = [f"{file}: {offence}" for file in files for offence in offences(file, topics, classes)]
    print("\n".join(found) if found else f"{len(files)} files: all fits")
    sys.exit(1 if found or not files else 0)


if __name__ == "__main__":
    main()
