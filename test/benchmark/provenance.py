# SPDX-License-Identifier: BSD-3-Clause
"""What a table measures, as hashes of files, and where and when it was measured."""
import datetime
import glob
import hashlib
import os
import platform
import re
import resource
import subprocess

TEXT = ('.yaml', '.yml', '.csv', '.h', '.cpp', '.py')


def contents_hash(path):
    """Of a text file without its comments and blank lines, so that these make no table older."""
    with open(path, 'rb') as file:
        data = file.read()
    if path.endswith(TEXT):
        mark = r'(^|\s)//.*' if path.endswith(('.h', '.cpp')) else r'(^|\s)#.*'
        lines = (re.sub(mark, '', line).rstrip() for line in data.decode('utf-8').splitlines())
        data = '\n'.join(line for line in lines if line).encode()
    return hashlib.sha256(data).hexdigest()[:12]


def files_named_in(path, root):
    """Files that a YAML file names, from its own folder or from config/: what it includes, robots, scenes, data."""
    with open(path, encoding='utf-8') as file:
        text = '\n'.join(re.sub(r'(^|\s)#.*', '', line) for line in file)
    for name in set(re.findall(r'[\w./-]+\.(?:yaml|csv|json|stl|vtk|msh|step|obj|npz)\b', text)):
        for folder in (os.path.dirname(path), os.path.join(root, 'config')):
            there = os.path.normpath(os.path.join(folder, name))
            if os.path.isfile(there):
                yield there
                break


def subject(patterns, root):
    """{file: hash} of files that match the patterns, from `root`, and of all that these name."""
    found = []
    for pattern in patterns:
        matches = sorted(glob.glob(os.path.join(root, pattern)))
        if not matches:
            raise ValueError('no file matches ' + pattern)
        found += matches
    seen = set()
    while found:
        path = found.pop()
        if path in seen:
            continue
        seen.add(path)
        if path.endswith('.yaml'):
            found += files_named_in(path, root)
    return {os.path.relpath(path, root): contents_hash(path) for path in sorted(seen)}


def changed_files(stored, patterns, root):
    """Files of a table's subject that are not what they were when it was measured."""
    today = subject(patterns, root)
    return sorted(path for path in set(stored) | set(today) if stored.get(path) != today.get(path))


def git(root, *arguments):
    return subprocess.run(['git', '-C', root, *arguments], check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout.strip()


def processor():
    with open('/proc/cpuinfo', encoding='ascii') as file:
        names = re.findall(r'model name\s*:\s*(.*)', file.read())
    return names[0] if names else platform.machine()


class Measuring:
    """`with Measuring(root) as measured: ...` fills measured.provenance."""

    def __init__(self, root):
        self.root, self.provenance = root, {}

    def __enter__(self):
        self.begin = datetime.datetime.now(datetime.timezone.utc)
        self.own_s, self.load, self.commit = self.children_s(), os.getloadavg()[0], git(self.root, 'rev-parse', '--short=8', 'HEAD')
        return self

    @staticmethod
    def children_s():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    def __exit__(self, *error):
        end = datetime.datetime.now(datetime.timezone.utc)
        self.provenance = {
            'date': self.begin.strftime('%Y-%m-%d'), 'commit': self.commit,
            'changed_sources': bool(git(self.root, 'status', '--porcelain', '--', 'src', 'include', 'config', ':!*.md', ':!config/doc')),
            'machine': processor(), 'cores': os.cpu_count(), 'load': [round(self.load, 1), round(os.getloadavg()[0], 1)],
            'cpu_s': round(self.children_s() - self.own_s, 1), 'wall_s': round((end - self.begin).total_seconds(), 1)}
