#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""launch_words_test.py ROOT: what a user gives to session.launch reaches programs as one word, whatever stands in it."""
import contextlib
import io
import os
import shlex
import sys

os.environ['ROS_PACKAGE_PATH'] = sys.argv[1] + ':' + os.environ.get('ROS_PACKAGE_PATH', '')
import roslaunch.config  # noqa: E402
import roslaunch.xmlloader  # noqa: E402


def words_of(node, *arguments):
    config = roslaunch.config.ROSLaunchConfig()
    loader = roslaunch.xmlloader.XmlLoader(resolve_anon=False)
    with contextlib.redirect_stdout(io.StringIO()):
        loader.load(sys.argv[1] + '/launch/session.launch', config, argv=list(arguments), verbose=False)
    return [shlex.split(one.args) for one in config.nodes if one.name == node][0]


for folder in ('/tmp/bags', '/tmp/my bags', "/tmp/it's here", '/tmp/"a" b\'c', '/tmp/ü  x'):
    words = words_of('recorder', 'record:=true', 'rviz:=false', 'bag_folder:=' + folder)
    assert words == [folder, 'spinebot', 'false'], words
    words = words_of('rig_emulator', 'emulated:=true', 'rviz:=false', 'rig:=/tmp/my rig.yaml')
    assert words[-1] == '/tmp/my rig.yaml', words
