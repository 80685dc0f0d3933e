#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_sources.py ROOT [CHECK...]: holds our sources to the rules of src/README.md that no compiler checks.

Lists every fault as FILE: what, and ends with 1. Checks: functions (by Universal Ctags), names, licences, headers, limits (all when none is named).
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


def functions(root):
    """(lines, file, name) of each function that is defined."""
    sources = '\n'.join(files(root, FOLDERS, ('.h', '.cpp')))
    tags = subprocess.run(
        ['ctags-universal', '-L', '-', '--languages=C++', '--langmap=C++:.cpp.h', '--kinds-C++=f', '--fields=+ne', '--output-format=json', '-f', '-'],
        input=sources, capture_output=True, text=True, cwd=root, check=True).stdout
    found = [json.loads(line) for line in tags.splitlines()]
    return [(tag['end'] - tag['line'] + 1, tag['path'], tag['name']) for tag in found if 'end' in tag]


def check_functions(root):
    found = functions(root)
    lines = sorted(length for length, _, _ in found)
    if not lines:
        return []
    faults = ['%s: %s has %d lines, at most %d' % (path, name, length, MOST_LINES) for length, path, name in found if length > MOST_LINES]
    if statistics.median(lines) > MEDIAN_LINES:
        faults.append('functions: the median has %g lines, at most %d' % (statistics.median(lines), MEDIAN_LINES))
    of_90_percent = lines[(9 * len(lines) + 9) // 10 - 1]
    if of_90_percent > MOST_LINES_OF_90_PERCENT:
        faults.append('functions: nine of ten have up to %d lines, at most %d' % (of_90_percent, MOST_LINES_OF_90_PERCENT))
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
OWN_LIMIT = re.compile(r'constexpr [\w:]+ (k(?:Largest|Most|Farthest|Longest|Max)\w*(?:_bytes|_gb|Copies|Rollouts|Depth|Nodes|Bytes)|kFarthest_m|kFarAway_m)'
                       r' = ([^;,]*)')
DOORS = ('settings', 'robot', 'control', 'programs')  # below src: what reads the files and requests of others


def check_limits(root):
    """Each limit has its row in config/README.md, and those that read files take theirs from there."""
    if not os.path.exists(os.path.join(root, LIMITS)):
        return []
    found = LIMIT.findall(re.sub(r'\n  +//', ' //', contents(root, LIMITS)))
    readme = contents(root, os.path.join('config', 'README.md'))
    faults = ['config/README.md: no row "| %s | %s |" for %s of limits.h' % (what, value, name) for name, value, what in found
              if '| %s | %s |' % (what, value) not in readme]
    for name in files(root, [os.path.join('src', door) for door in DOORS], ('.h', '.cpp')):
        faults += ['%s: %s is a limit of its own, %s; take it from settings/limits.h' % (name, what, value)
                   for what, value in OWN_LIMIT.findall(contents(root, name)) if name != LIMITS and 'limits::' not in value]
    return faults


CHECKS = {'functions': check_functions, 'names': check_names, 'licences': check_licences, 'headers': check_headers, 'limits': check_limits}


def main():
    root, names = sys.argv[1], sys.argv[2:] or list(CHECKS)
    faults = [fault for name in names for fault in CHECKS[name](root)]
    print('\n'.join(faults))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
