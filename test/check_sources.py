#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_sources.py ROOT [CHECK...]: holds our sources to the rules of src/README.md that no compiler checks.

Lists every fault as FILE: what, and ends with 1. Checks: functions and classes (by Universal Ctags), names, licences, headers, limits (all when none is named).
"""
import json
import os
import re
import statistics
import subprocess
import sys

FOLDERS = ('src', 'include', 'test')
SKIPPED = {os.path.join('test', 'data')}
MEDIAN_LINES, MOST_LINES_OF_90_PERCENT, MOST_LINES = 10, 22, 60  # of functions, from signature to closing brace
MOST_PATHS = 20  # cyclomatic complexity (McCabe 1976): decisions, and one
MOST_MEMBERS = 15  # data members of a class; structs, which only name what they hold, may have more
MOST_PUBLIC = 25  # public functions of a class, beside constructors and operators
# What users build and ask by one name; these may not grow.
MORE_PUBLIC = {'Body': 39, 'YamlNode': 32, 'Simulation': 27}
MOST_HEADERS = 45  # for users and plugins; few are a promise that is kept

# Names that had a better one in the field; the right ones stand in the glossary of src/README.md.
OLD_NAMES = {
    'gauss_seidel': 'xpbd', 'MarkerSight': 'MarkerDetection', 'CameraSight': 'CameraObservation', 'MarkerBeliefs': 'MarkerEstimator',
    'CameraWatch': 'ExtrinsicsMonitor', 'knocked': 'displaced', 'Reality': 'Plant', 'reality_node': 'plant_node',
    'LateReality': 'RealTimePlant', 'CameraRig': 'CameraSetup', 'SettingsNode': 'YamlNode', 'Announcement': 'LatchedPublisher',
    'advertise_to_newcomers': 'LatchedPublisher', 'Film': 'FrameRecorder', 'Shot': 'Capture', 'Stage': 'RayScene',
    'Glance': 'RayHit', 'Foot': 'ClosestPoint', 'softness': 'compliance', 'Junction': 'FrictionContact', 'lay_over': 'merge',
    'place_m': 'position_m', 'packs': 'batches', 'slop_s': 'sync_tolerance_s', 'patience_s': 'timeout_s',
    'unfold': 'untangle', 'folded_steps': 'inverted_steps', 'TrackerStep': 'TrackerUpdateLog', 'lenses': 'camera_infos',
    'hold_voltage': 'hold_voltage_ratio', 'centre_m': 'center_m',
}
NAMED_IN = ('src', 'include', 'config', 'launch', 'msg', 'srv', 'README.md')
TEXTS = ('.h', '.cpp', '.yaml', '.md', '.msg', '.srv', '.launch', '.sh', '.py', '.xml', '.txt')
LICENSED = ('.h', '.cpp', '.c', '.py', '.sh')


def files(root, folders, ends):
    for folder in folders:
        top = os.path.join(root, folder)
        if os.path.isfile(top):
            yield folder
        for place, folders_below, names in os.walk(top):
            folders_below[:] = sorted(f for f in folders_below if os.path.relpath(os.path.join(place, f), root) not in SKIPPED)
            for name in sorted(names):
                if name.endswith(ends):
                    yield os.path.relpath(os.path.join(place, name), root)


def contents(root, name):
    with open(os.path.join(root, name), encoding='utf-8') as file:
        return file.read()


DECISION = re.compile(r'\b(?:if|for|while|case|catch)\b|&&|\|\||\?')
NO_CODE = re.compile(r'''//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])[']''', re.S)


def tags(root, folders, kinds):
    """Of what C++ defines there, as Universal Ctags has it."""
    sources = '\n'.join(files(root, folders, ('.h', '.cpp')))
    lines = subprocess.run(
        ['ctags-universal', '-L', '-', '--languages=C++', '--langmap=C++:.cpp.h', '--kinds-C++=' + kinds, '--fields=+anesZ',
         '--fields-C++=+{properties}', '--output-format=json', '-f', '-'],
        input=sources, capture_output=True, text=True, cwd=root, check=True).stdout
    return [json.loads(line) for line in lines.splitlines()]


def functions(root):
    """(file, name, first line, last line) of each function that is defined."""
    return [(tag['path'], tag['name'], tag['line'], tag['end']) for tag in tags(root, FOLDERS, 'f') if 'end' in tag]


def too_many_paths(root, found):
    code = {path: NO_CODE.sub(lambda gone: '\n' * gone.group().count('\n'), contents(root, path)).split('\n')
            for path in {path for path, _, _, _ in found if path.startswith(('src', 'include'))}}
    for path, name, first, last in found:
        paths = 1 + len(DECISION.findall('\n'.join(code[path][first - 1:last]))) if path in code else 0
        if paths > MOST_PATHS:
            yield '%s: %s has a cyclomatic complexity of %d, at most %d' % (path, name, paths, MOST_PATHS)


def check_functions(root):
    found = functions(root)
    lines = sorted(last - first + 1 for _, _, first, last in found)
    if not lines:
        return []
    faults = ['%s: %s has %d lines, at most %d' % (path, name, last - first + 1, MOST_LINES) for path, name, first, last in found
              if last - first + 1 > MOST_LINES]
    faults += too_many_paths(root, found)
    if statistics.median(lines) > MEDIAN_LINES:
        faults.append('functions: the median has %g lines, at most %d' % (statistics.median(lines), MEDIAN_LINES))
    of_90_percent = lines[(9 * len(lines) + 9) // 10 - 1]
    if of_90_percent > MOST_LINES_OF_90_PERCENT:
        faults.append('functions: nine of ten have up to %d lines, at most %d' % (of_90_percent, MOST_LINES_OF_90_PERCENT))
    return faults


def check_classes(root):
    members, public = {}, {}
    for tag in tags(root, ('src', 'include'), 'cfmp'):
        if tag.get('scopeKind') != 'class':
            continue
        name = tag['scope'].split('::')[-1]
        if tag['kind'] == 'member' and 'static' not in tag.get('properties', ''):
            members.setdefault((tag['path'], name), []).append(tag['name'])
        if tag['kind'] in ('function', 'prototype') and tag.get('access') == 'public' and not re.match('operator|~?%s$' % name, tag['name']):
            public.setdefault((tag['path'], name), []).append(tag['name'])
    faults = ['%s: %s has %d data members, at most %d' % (path, name, len(all_of_it), MOST_MEMBERS)
              for (path, name), all_of_it in members.items() if len(all_of_it) > MOST_MEMBERS]
    for (path, name), all_of_it in public.items():
        most = MORE_PUBLIC.get(name, MOST_PUBLIC)
        if len(all_of_it) > most:
            faults.append('%s: %s has %d public functions, at most %d' % (path, name, len(all_of_it), most))
    return faults


def check_names(root):
    old = re.compile(r'\b(%s)\b' % '|'.join(OLD_NAMES))
    faults = []
    for name in files(root, NAMED_IN, TEXTS):
        for number, line in enumerate(contents(root, name).splitlines(), 1):
            faults += ['%s:%d: %s is %s' % (name, number, word, OLD_NAMES[word]) for word in old.findall(line)]
    return faults


def check_licences(root):
    return ['%s: no SPDX-License-Identifier in its first two lines' % name for name in files(root, FOLDERS + ('launch',), LICENSED)
            if 'SPDX-License-Identifier' not in ''.join(contents(root, name).splitlines()[:2])]


def check_headers(root):
    """Of the interface: a comment says what each type is for, and they are few."""
    names = list(files(root, ('include',), ('.h',)))
    faults = []
    for name in names:
        lines = contents(root, name).splitlines()
        of_the_file = len(lines) > 1 and lines[1].startswith('// ')
        faults += ['%s:%d: no comment says what %s is' % (name, number + 1, ' '.join(line.split()[:2])) for number, line in enumerate(lines)
                   if re.match(r'(class|struct|enum) .*\{', line) and not of_the_file
                   and not re.match(r'//|template', lines[number - 1])]
    return faults + (['include: %d headers, at most %d' % (len(names), MOST_HEADERS)] if len(names) > MOST_HEADERS else [])


LIMITS = os.path.join('src', 'settings', 'limits.h')
LIMIT = re.compile(r'inline constexpr \S+ (k\w+) = ([^;]+); +// (.*)')
OWN_LIMIT = re.compile(r'constexpr [\w:]+ (k?(?:[Ll]argest|[Mm]ost|[Ff]arthest|[Ll]ongest|[Mm]ax)_?\w*(?:_bytes|_gb|Copies|Rollouts|Depth|depth_m|Nodes|Bytes'
                       r'|Threads|Workers|Slots|Tasks|Samples|Weight|Elements|[Ll]ine|Command)|kMost(?:Steps|Iterations)|kFarthest_m|kFarAway_m)'
                       r' = ([^;,]*)')
DOORS = ('settings', 'robot', 'control', 'session', 'study', 'perception', 'hardware', 'ros', 'programs', 'python')  # below src: what files, requests and others reach
INSIDE = {  # no limits of what comes in
    'src/robot/casting/thickness.cpp': 'points that are looked from', 'src/robot/casting/extraction.cpp': 'rounds', 'src/hardware/motor/wire.h': 'the protocol'}
# What turns text into numbers, and what bounds them there.
TO_NUMBER = re.compile(r'\b(sto[dfil]\w*|strto\w+|ato[fil]|from_chars|sscanf)\(')
READERS = {
    'src/settings/words.h': 'its callers', 'src/programs/mesher/read_vtk.cpp': 'the size of the file; check_mesh', 'src/mechanics/mesh/mesh_file.cpp': 'check_mesh',
    'src/programs/mesher/msh_counts.cpp': 'compared with the lines that are there', 'src/ros/recording/message_layout.cpp': 'definitions of messages',
    'src/ros/panel/poses.cpp': 'two digits', 'src/hardware/emulator/control.cpp': 'the range of each word', 'src/hardware/testbench/testbench.cpp': 'two digits',
    'src/study/experiments/': 'overrides of a scene, and arguments of its own', 'src/study/charts/': 'overrides of a scene'}
PARAMETERS = os.path.join('src', 'ros', 'nodes', 'read_parameter.h')
ROS_PARAMETER = re.compile(r'\bgetParam(?:Cached)?\(|\.param(?:<[^;]*?>)?\(')
ARGUMENTS = os.path.join('src', 'settings', 'command_line.cpp')
HEARD = re.compile(r'subscribe<(?:\w+::)?(\w+)>|\b(?:on|add)_\w+\(const (\w+)&')


def own_limits(root):
    """Limits, readers of text, parameters and arguments beside the doors that take theirs from limits.h."""
    faults = []
    for name in files(root, [os.path.join('src', door) for door in DOORS], ('.h', '.cpp')):
        text = contents(root, name)
        if name not in INSIDE:
            faults += ['%s: %s is a limit of its own, %s; take it from settings/limits.h' % (name, what, value)
                       for what, value in OWN_LIMIT.findall(text) if name != LIMITS and 'limits::' not in value]
        if not name.startswith(tuple(READERS)):
            faults += ['%s: %s() reads a number without a limit; parse_number() and settings/limits.h do' % (name, what) for what in TO_NUMBER.findall(text)]
        if name != PARAMETERS and name.startswith(os.path.join('src', 'ros')) and ROS_PARAMETER.search(text):
            faults.append('%s: reads a parameter without a limit; read_parameter() does' % name)
        if not name.startswith(ARGUMENTS[:-3]) and 'CLI::' in text:
            faults.append('%s: reads arguments without limits; CommandLine does' % name)
    return faults


def has_numbers(root, lines):
    """Of a message's or request's definition: a floating-point number, in it or in a message within."""
    for line in lines:
        kind = (line.split('#')[0].split() or [''])[0].split('/')[-1].split('[')[0]
        own = os.path.join(root, 'msg', kind + '.msg')
        if kind in ('float32', 'float64', 'Point', 'Vector3', 'Pose', 'PoseStamped'):
            return True
        if os.path.exists(own) and has_numbers(root, contents(root, os.path.join('msg', kind + '.msg')).splitlines()):
            return True
    return False


def doors_of_messages(root):
    """Requests, goals and messages that a node hears are handed to require_in_limits<TYPE>() or is_in_limits<TYPE>()."""
    sources = {name: contents(root, name) for name in files(root, [os.path.join('src', 'ros')], ('.h', '.cpp'))}
    checked = set(re.findall(r'in_limits<([\w:]+)>', '\n'.join(sources.values())))
    needed = {}
    for folder, ending, suffix in (('srv', '.srv', '::Request'), ('action', '.action', 'Goal')):
        for name in files(root, [folder], (ending,)):
            kind = os.path.basename(name)[:-len(ending)]
            if has_numbers(root, contents(root, name).split('\n---')[0].splitlines()) and not kind + '::Request' in checked:
                needed[kind + suffix] = name
    for name, text in sources.items():
        for kind in {one or other for one, other in HEARD.findall(text)} if os.path.join('ros', 'panel') not in name else ():
            path = os.path.join('msg', kind + '.msg')
            if os.path.exists(os.path.join(root, path)) and has_numbers(root, contents(root, path).splitlines()):
                needed.setdefault(kind, name)
    return ['%s: the numbers of %s come in without a limit; require_in_limits<%s>() does' % (name, kind, kind) for kind, name in sorted(needed.items())
            if kind not in checked]


def check_limits(root):
    """Each limit has its row in config/README.md, and every door takes its limits from there."""
    if not os.path.exists(os.path.join(root, LIMITS)):
        return []
    found = LIMIT.findall(re.sub(r'\n  +//', ' //', contents(root, LIMITS)))
    readme = contents(root, os.path.join('config', 'README.md'))
    faults = ['config/README.md: no row "| %s | %s |" for %s of limits.h' % (what, value, name) for name, value, what in found
              if '| %s | %s |' % (what, value) not in readme]
    return faults + own_limits(root) + doors_of_messages(root)


CHECKS = {'functions': check_functions, 'classes': check_classes, 'names': check_names, 'licences': check_licences, 'headers': check_headers, 'limits': check_limits}


def main():
    root, names = sys.argv[1], sys.argv[2:] or list(CHECKS)
    faults = [fault for name in names for fault in CHECKS[name](root)]
    print('\n'.join(faults))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
