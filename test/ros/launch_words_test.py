#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""launch_words_test.py ROOT: what a user gives to launch files reaches programs as one word, or is refused before nodes start."""
import contextlib
import io
import os
import shlex
import subprocess
import sys
import tempfile

os.environ['ROS_PACKAGE_PATH'] = sys.argv[1] + ':' + os.environ.get('ROS_PACKAGE_PATH', '')
import roslaunch.config  # noqa: E402
import roslaunch.xmlloader  # noqa: E402


def words_of(node, *arguments):
    config = roslaunch.config.ROSLaunchConfig()
    loader = roslaunch.xmlloader.XmlLoader(resolve_anon=False)
    with contextlib.redirect_stdout(io.StringIO()):
        loader.load(sys.argv[1] + '/launch/session.launch', config, argv=list(arguments), verbose=False)
    return [shlex.split(one.args) for one in config.nodes if one.name == node][0]


path = os.environ['PATH']
no_checks = tempfile.TemporaryDirectory()
os.symlink('/bin/true', no_checks.name + '/rosrun')
os.environ['PATH'] = no_checks.name + ':' + path
lab = tempfile.TemporaryDirectory()
for name in ('bags', 'my bags', "it's here", '"a" b\'c', 'ü  x'):
    folder = lab.name + '/' + name
    os.mkdir(folder)
    for file in ('motors.yaml', 'plant.yaml'):
        open(folder + '/' + file, 'w').close()
    words = words_of('recorder', 'record:=true', 'rviz:=false', 'bag_folder:=' + folder)
    assert words == [folder, 'spinebot', 'false'], words
    words = words_of('rig_emulator', 'emulated:=true', 'rviz:=false', 'rig_folder:=' + folder)
    assert words[-1] == folder + '/motors.yaml', words
    words = words_of('motor', 'emulated:=true', 'rviz:=false', 'rig_folder:=' + folder)
    assert words[0] == '_rig:=' + folder + '/motors.yaml', words
os.environ['PATH'] = path


def refusal(file, *arguments):
    """What roslaunch says of arguments before any node starts; it ends with a status that is not 0."""
    run = subprocess.run(['roslaunch', '--nodes', sys.argv[1] + '/launch/' + file, *arguments], stderr=subprocess.PIPE,
                         stdout=subprocess.DEVNULL, text=True)
    assert (run.returncode != 0) == bool(run.stderr), (run.returncode, run.stderr)
    return run.stderr


assert "robot: there is no 'spinbot' (did you mean 'spinebot'?); known: bubblebot, " in refusal('session.launch', 'robot:=spinbot')
assert "cameras: there is no 'renderd' (did you mean 'rendered'?); known: none, rendered" in refusal('session.launch', 'cameras:=renderd')
for switch in ('emulated', 'hardware', 'record', 'record_images', 'rviz', 'twin', 'wall_clock'):
    assert switch + ": there is no 'maybe'; known: true, false" in refusal('session.launch', switch + ':=maybe'), switch
assert "session.launch: there is no 'emulted' (did you mean 'emulated'?); known: " in refusal('session.launch', 'emulted:=true')
assert "view.launch: there is no 'rvz' (did you mean 'rviz'?)" in refusal(
    'view.launch', 'rvz:=false', 'scene:=' + sys.argv[1] + '/test/data/scenes/cable_bar.yaml')
assert "motor.launch: there is no 'rigg' (did you mean 'rig'?); known: " in refusal('motor.launch', 'rigg:=x.yaml')
assert "robot: there is no 'griper' (did you mean 'gripper'?)" in refusal('motor.launch', 'robot:=griper')
assert "robot: there is no 'xyz'; known" in refusal('session.launch', 'robot:=xyz')
no_rig = refusal('session.launch', 'robot:=hanging_bar', 'emulated:=true')
assert 'hanging_bar/plant.yaml' in no_rig and 'new_rig ROBOT.yaml` writes' in no_rig, no_rig
assert 'there is no file /nowhere/plant.yaml' in refusal('session.launch', 'rig_folder:=/nowhere', 'emulated:=true')
assert "scene: there is no file /nowhere/it's.yaml" in refusal('session.launch', "scene:=/nowhere/it's.yaml")
assert "robot: there is no 'gripr'" in refusal('replay.launch', 'bag:=session.bag', 'output:=markers.bag', 'robot:=gripr')
unknown_key = refusal('session.launch', 'scene:=' + sys.argv[1] + '/test/data/scenes/unknown_key.yaml')
assert "unknown_key.yaml:5: body: unknown key 'colour'" in unknown_key and 'cannot be run' in unknown_key, unknown_key
assert "unknown key 'colour'" in refusal('view.launch', 'scene:=' + sys.argv[1] + '/test/data/scenes/unknown_key.yaml')
assert not refusal('session.launch', 'scene:=' + sys.argv[1] + '/test/data/scenes/cable_bar.yaml', 'robot:=mine')
