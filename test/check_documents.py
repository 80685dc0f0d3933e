#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_documents.py ROOT [CHECK...]: holds the READMEs to the tree that they describe, and to the rules of their language.

Lists every fault as FILE: what, and ends with 1. Checks: keys, interface, links, length, sentences, words (all when none is named).
"""
import fnmatch
import glob
import os
import re
import statistics
import sys
from xml.etree import ElementTree

import yaml

MOST_LINES = 150  # of the first README
MOST_WORDS = 16  # of the median sentence
SKIPPED = {'build', 'devel', '.git', 'install', 'documents'}  # test/data/documents: wrong on purpose

# Sections of config/README.md: which files' keys they describe, and which sources read those. Of sources in `strict` every
# word that could be a key or a choice is looked for; of the others only what reads settings is.
SECTIONS = {
    'Scene': {
        'config': ['robots/*/robot.yaml', 'robots/*/fine.yaml', 'scenes'],
        'strict': ['mechanics/actuators', 'mechanics/mesh/cable_path.cpp', 'robot/design/solid.cpp', 'robot/design/mesh_refinement.cpp', 'robot/design/casting_settings.cpp',
                   'robot/scene/actuator_section.cpp', 'robot/scene/body_section.cpp', 'robot/scene/fibre_section.cpp', 'robot/scene/contact_section.cpp',
                   'robot/scene/fidelity_section.cpp', 'robot/scene/include_files.cpp', 'robot/scene/material_section.cpp', 'robot/scene/mesh_section.cpp',
                   'robot/scene/obstacle_mesh.cpp', 'robot/scene/parameters.cpp', 'robot/scene/reduction_section.cpp', 'robot/scene/run_section.cpp', 'robot/scene/solver_section.cpp'],
        'loose': ['robot/scene/choose_fidelity.cpp', 'robot/scene/fidelity_ladder.cpp', 'robot/scene/fidelity_report.cpp',
                  'robot/scene/part_effects.cpp', 'robot/scene/scene_cables.cpp',
                  'robot/scene/scene_file.cpp', 'robot/scene/plausible_sizes.cpp', 'robot/design/mesher.cpp', 'robot/design/surface_file.cpp',
                  'robot/casting/cast_robot.cpp', 'robot/scene/cable_warnings.cpp', 'programs/export_solid.cpp',
                  'programs/new_rig.cpp', 'programs/rig'],
    },
    'Material preset': {'config': ['materials']},
    'Motor rig': {'config': ['robots/*/motors.yaml', 'motors'], 'strict': ['hardware/motor/rig_settings.cpp'], 'no_keys': {'channels'}},
    'Pressure rig': {'config': ['robots/*/pressures.yaml'], 'strict': ['hardware/motor/pressure_settings.cpp']},
    'Plant': {'config': [], 'strict': ['hardware/plant/plant.cpp']},  # `robot` is a scene
    'Camera setup': {'config': ['cameras'], 'but': ['cameras/*_poses.yaml'],
                     'strict': ['perception/render/camera_setup.cpp', 'perception/render/sensor_model.cpp']},
    'Camera poses': {'config': ['cameras/*_poses.yaml'], 'strict': ['perception/calibration/camera_pose.cpp']},
    'Calibration balls': {'config': ['robots/*/balls.yaml'], 'strict': ['perception/calibration/calibration.cpp'],
                          'no_keys': {'markers'}},  # of calibrate_by_markers, which reads no file
    'Tracker': {'config': ['robots/*/tracker*.yaml'], 'strict': ['perception/tracking/tracker_settings.cpp']},
    'Task': {'config': ['robots/*/tasks'], 'loose': ['ros/nodes/reach_target_node.cpp', 'study/reach_targets.cpp']},
    'Policy': {'config': [], 'strict': ['control/policy.cpp']},
    'Study': {'config': ['studies'], 'strict': ['study/sweeps/study_file.cpp']},
    'Randomisation': {'config': ['robots/*/random.yaml'], 'strict': ['study/robust/randomisation_file.cpp']},
    'Path': {'config': ['tasks/paths'], 'strict': ['control/motion/path_task.cpp'], 'no_keys': {'path'}},
    'Learning task': {'config': ['tasks'], 'but': ['tasks/paths'], 'strict': ['python/core/bind_learning_task.cpp'],
                      'no_keys': {'_draw_robots', '_read_learning_task', 'overrides', 'reshape'}},  # Python's
    'Search': {'config': ['searches'], 'strict': ['study/search/search_file.cpp']},
    'Experiments': {'config': ['experiments'], 'loose': ['study', 'control/configuration_table.cpp', 'programs/bullet_peer.cpp']},
}
# These read what no user writes: requests of our own programs, tables, what another program measured.
NO_FILE_OF_A_USER = {'hardware/emulator/control.cpp', 'programs/mesh_robot.cpp', 'ros/display/overlay.cpp', 'settings'}
# Words in strict sources that are neither keys nor choices: units, parts of messages, settings of a camera's driver.
NO_KEYS = {'m', 'ml', 'N', 'Pa', 'node', 'exposure', 'gain', 'before', 'now', 'none', 'choice', 'gravity', 'nodes'}
# Columns of tables in config/reference, which are read in the same way.
COLUMNS = {'law', 'nu', 'tip_uy_m', 'beta', 'V_over_V0', 'P_gauge_Pa', 't_s', 'f1_bend_Hz', 'problem', 'x_m', 'y_m', 'z_m',
           'ux_m', 'uy_m', 'uz_m'}
# Below these keys stand names of the user's, or keys that another section describes.
NAMES_BELOW = {'colours', 'marker_colours', 'overrides', 'backlash_steps', 'meshes', 'where', 'values', 'changes',
               'set_up', 'methods', 'betas', 'commands', 'sensor', 'depth', 'solver', 'parameters', 'limits'}

READS = r'(?:child|sequence|number|integer|boolean|text|choice|vector3|has|optional_child|optional_sequence|' \
        r'(?:number|integer|boolean|text|choice|vector3)_or)'
KEY = r'"([A-Za-z][A-Za-z0-9_]*)"'


def files(root, *ends):
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(f for f in folders if f not in SKIPPED and not f.startswith('.'))
        for name in sorted(names):
            if name.endswith(ends):
                yield os.path.join(folder, name)


def contents(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


def readmes(root):
    return [path for path in files(root, 'README.md')]


# ---- keys

def section_of(text, title):
    found = re.search(r'^## ' + re.escape(title) + r'\n(.*?)(?=^## |\Z)', text, re.M | re.S)
    return found.group(1) if found else ''


def words_in_code(text):
    text = re.sub(r'^```.*?^```', '', text, flags=re.M | re.S)  # an example does not describe
    return {word for code in re.findall(r'`([^`]+)`', text) for word in re.findall(r'[A-Za-z][A-Za-z0-9_]*', code)}


def without_comments(text):
    return re.sub(r'//.*', '', text)


def helpers(text):
    """Functions that take a key, or a node and a key: their calls read settings too."""
    named = re.findall(r'(\w+)\(const YamlNode& \w+, const std::string& \w+', text)
    return named + re.findall(r'auto (\w+) = \[&\]\(const std::string& key\)', text)


def keys_read(text):
    text = without_comments(text)
    keys = set(re.findall(r'(?:\.|->)' + READS + r'\(\s*' + KEY, text))
    for helper in helpers(text):
        keys |= set(re.findall(r'\b' + helper + r'\((?:[\w.>-]+, )?' + KEY, text))
    return keys


def all_words(text):
    return set(re.findall(KEY, without_comments(text)))


def keys_of_file(node):
    if isinstance(node, list):
        return set().union(*map(keys_of_file, node)) if node else set()
    if not isinstance(node, dict):
        return set()
    keys = {str(key) for key in node if not re.fullmatch(r'\[\d+\]', str(key))}  # but items by place
    for key, value in node.items():
        if key in NAMES_BELOW and isinstance(value, dict):
            continue
        if key == 'commands' and isinstance(value, list):  # times, and actuators by name
            continue
        if key in ('cables', 'chambers') and isinstance(value, dict):  # of an included scene, by name
            value = list(value.values())
        keys |= keys_of_file(value)
    return keys


def below(path, places):
    return any(fnmatch.fnmatch(path, place) or path.startswith(place + '/') for place in places)


def check_keys(root):
    readme = contents(os.path.join(root, 'config/README.md'))
    faults = []
    known = set(NO_FILE_OF_A_USER)
    for title, section in SECTIONS.items():
        words = words_in_code(section_of(readme, title))
        strict, loose = section.get('strict', []), section.get('loose', [])
        for path in files(os.path.join(root, 'src'), '.cpp', '.h'):
            name = os.path.relpath(path, os.path.join(root, 'src'))
            text = contents(path)
            if below(name, strict) and 'YamlNode' in text:
                known.add(name)
                wanted = all_words(text) - NO_KEYS - section.get('no_keys', set())
            elif below(name, loose) and name not in known:
                known.add(name)
                wanted = keys_read(text) - COLUMNS
            else:
                continue
            faults += ['src/%s: `%s` is not described in config/README.md, section %s' % (name, key, title)
                       for key in sorted(wanted - words)]
        for path in files(os.path.join(root, 'config'), '.yaml'):
            name = os.path.relpath(path, os.path.join(root, 'config'))
            if below(name, section['config']) and not below(name, section.get('but', [])):
                faults += ['config/%s: `%s` is not described in config/README.md, section %s' % (name, key, title)
                           for key in sorted(keys_of_file(yaml.safe_load(contents(path))) - words)]
    for path in files(os.path.join(root, 'src'), '.cpp', '.h'):
        name = os.path.relpath(path, os.path.join(root, 'src'))
        text = contents(path)
        if 'YamlNode' in text and keys_read(text) and not below(name, known):
            faults.append('src/%s: reads settings, but belongs to no section of config/README.md' % name)
    return faults


# ---- arguments, messages

def check_interface(root):
    faults = []
    words = words_in_code(contents(os.path.join(root, 'launch/README.md')))
    for path in files(os.path.join(root, 'launch'), '.launch'):
        for argument in ElementTree.parse(path).getroot().iter('arg'):
            name = argument.get('name')
            asked_for = argument.get('value') is None
            if asked_for and name not in words:
                faults.append('%s: `%s` is not described in launch/README.md' % (os.path.relpath(path, root), name))
            if asked_for and not argument.get('doc'):  # what `roslaunch --ros-args` prints
                faults.append('%s: `%s` has no doc' % (os.path.relpath(path, root), name))
    readme = contents(os.path.join(root, 'msg/README.md'))
    for path in files(root, '.msg', '.srv', '.action'):
        if path.startswith(os.path.join(root, 'test', 'data')):
            continue
        name = os.path.splitext(os.path.basename(path))[0]
        if '[%s](' % name not in readme:
            faults.append('%s is not named in msg/README.md' % os.path.relpath(path, root))
    return faults


# ---- links

def anchors(text):
    titles = re.findall(r'^#+ (.*)$', re.sub(r'^```.*?^```', '', text, flags=re.M | re.S), re.M)
    return {re.sub(r'[^\w\- ]', '', title.lower()).strip().replace(' ', '-') for title in titles}


def check_links(root):
    faults = []
    for path in readmes(root):
        name, text = os.path.relpath(path, root), contents(path)
        prose = re.sub(r'^```.*?^```', '', text, flags=re.M | re.S)
        for target in re.findall(r'\]\(([^)\s]+)\)', prose):
            if re.match(r'https?://', target):
                continue
            file, _, anchor = target.partition('#')
            there = os.path.normpath(os.path.join(os.path.dirname(path), file)) if file else path
            if not os.path.exists(there):
                faults.append('%s: there is no %s' % (name, target))
            elif anchor and anchor not in anchors(contents(there)):
                faults.append('%s: no heading %s' % (name, target))
        for place in re.findall(r'`\.?/?((?:config|include|launch|msg|src|srv|test)/[\w./-]*)`', prose):
            if not glob.glob(os.path.join(root, re.sub(r'ROBOT|NAME|CAMERA', '*', place))):  # ROBOT stands for any
                faults.append('%s: there is no %s' % (name, place))
    return faults


# ---- language

def check_length(root):
    lines = contents(os.path.join(root, 'README.md')).count('\n')
    return ['README.md: %d lines, at most %d' % (lines, MOST_LINES)] if lines > MOST_LINES else []


def sentences(text):
    """Of paragraphs and items of lists; tables, code, headings and pictures have none."""
    text = re.sub(r'^```.*?^```', '\n', text, flags=re.M | re.S)
    text = re.sub(r'^(\||#|    |!\[).*$', '\n', text, flags=re.M)
    text = re.sub(r'^ *(?:[-*]|\d+\.) ', '\n\n', text, flags=re.M)
    found = []
    for paragraph in re.split(r'\n\s*\n', text):
        plain = re.sub(r'`[^`]*`', 'code', ' '.join(paragraph.split()))
        plain = re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', plain)
        found += [s for s in re.split(r'(?<=[.!?:])\s+', plain) if len(s.split()) > 1]
    return found


def check_sentences(root):
    lengths = [len(s.split()) for path in readmes(root) for s in sentences(contents(path))]
    median = statistics.median(lengths)
    return ['READMEs: the median sentence has %g words, at most %d' % (median, MOST_WORDS)] if median > MOST_WORDS else []


def check_words(root):
    faults = []
    vague = re.compile(r'\b(tel' r'l|tel' r'ls|tol' r'd|tel' r'ling)\b', re.I)
    ends = ('.md', '.rst', '.yaml', '.cpp', '.h', '.txt', '.cmake', '.sh', '.py', '.launch', '.test', '.msg', '.srv', '.xml')
    for path in files(root, *ends):
        for number, line in enumerate(contents(path).splitlines(), 1):
            if vague.search(line):
                faults.append('%s:%d: says "%s"; name what happens' % (
                    os.path.relpath(path, root), number, vague.search(line).group(0)))
    return faults


CHECKS = {'keys': check_keys, 'interface': check_interface, 'links': check_links, 'length': check_length, 'sentences': check_sentences, 'words': check_words}


def main():
    root, names = sys.argv[1], sys.argv[2:] or list(CHECKS)
    faults = [fault for name in names for fault in CHECKS[name](root)]
    print('\n'.join(faults))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
