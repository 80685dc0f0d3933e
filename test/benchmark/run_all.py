#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the tables of README.md beside this file, stores them in results/, and writes that page from what is stored.

    run_all.py --list                      names of all tables, with the CPU time that each took
    run_all.py NAME...                     measures these, or `all`, stores them, and writes the page
    run_all.py --older                     measures all that are older than their subject, likewise
    run_all.py --write                     writes the page alone
    run_all.py --check page|subjects       ends with 1 where the page is not what is stored, or a table is older than its subject
"""
import argparse
import contextlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import page
import provenance
from tables import TABLES

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))


def result_file(folder, name):
    return os.path.join(folder, name + '.json')


def stored(folder):
    """{name: result} of all tables that were measured."""
    results = {}
    for table in TABLES:
        if os.path.exists(result_file(folder, table.name)):
            with open(result_file(folder, table.name), encoding='utf-8') as file:
                results[table.name] = json.load(file)
    return results


def run_command(command, programs, out):
    """What a command writes: its file `reads` where it has one, else its output."""
    words = [word.format(out=out, root=ROOT) for word in command.words]
    environment = {**os.environ, 'OPENBLAS_NUM_THREADS': '1', 'OMP_NUM_THREADS': '1'}
    done = subprocess.run([os.path.join(programs, words[0])] + words[1:], cwd=ROOT, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, universal_newlines=True, check=False)
    if done.returncode not in (0, 1):  # 1: not all of it went well, which the table says
        raise RuntimeError('%s ended with %d' % (' '.join(words), done.returncode))
    if not command.reads:
        return done.stdout
    with open(command.reads.format(out=out), encoding='utf-8') as file:
        return file.read()


def shown(words):
    """A command without where its files go."""
    text = re.sub(r'( --?\w+)? \{out\}\S*| --\w+=\S*\{out\}\S*', '', ' '.join(words))
    return text.replace('{root}/', '').replace('/bin/cat ', '')


def measure(table, programs, folder, keep):
    with contextlib.ExitStack() as stack:
        out = os.path.join(keep, table.name) if keep else stack.enter_context(tempfile.TemporaryDirectory())
        os.makedirs(out, exist_ok=True)
        with provenance.Measuring(ROOT) as measured:
            texts = {command.label: run_command(command, programs, out) for command in table.commands}
        result = table.parse(texts)
        pictures = {}
        for made, name in table.pictures.items():
            kept = os.path.join(ROOT, 'config', 'doc', name)
            shutil.copyfile(os.path.join(out, made), kept)
            pictures[name] = provenance.contents_hash(kept)
    commands = [shown(command.words) for command in table.commands]
    result = {**result, 'pictures': pictures, 'measured': {**measured.provenance, 'commands': commands},
              'subject': provenance.subject(table.subject, ROOT)}
    with open(result_file(folder, table.name), 'w', encoding='utf-8') as file:
        file.write(json_text(result))


def json_text(result):
    """With a row of the table in a line."""
    text = json.dumps(result, indent=1, ensure_ascii=False)
    return re.sub(r'\[\n\s+([^\[\]{}]*?)\n\s+\]', lambda found: '[' + re.sub(r',\n\s+', ', ', found.group(1)) + ']', text) + '\n'


def older(results, root=ROOT):
    """{name: files that changed} of tables that were measured on another subject."""
    changed = {table.name: provenance.changed_files(results[table.name]['subject'], table.subject, root)
               for table in TABLES if table.name in results}
    return {name: files for name, files in changed.items() if files}


def faults_of_page(results, path):
    with open(path, encoding='utf-8') as file:
        written = file.read()
    wanted = page.text(TABLES, results, older(results))
    faults = [] if written == wanted else [path + ' is not what `run_all.py --write` makes of what is stored']
    if wanted.count('\n') > page.MOST_LINES:
        faults.append('%s would have %d lines, at most %d' % (path, wanted.count('\n'), page.MOST_LINES))
    for name, result in results.items():
        for picture, measured in result['pictures'].items():
            if provenance.contents_hash(os.path.join(ROOT, 'config', 'doc', picture)) != measured:
                faults.append('config/doc/%s is not the picture of table %s' % (picture, name))
    known = {table.name + '.json' for table in TABLES}
    return faults + ['results/%s belongs to no table' % name for name in sorted(set(os.listdir(os.path.join(HERE, 'results'))) - known)]


def faults_of_subjects(results):
    return ['table %s is older than its subject: %s changed; measure it anew by `run_all.py %s`' % (name, ', '.join(files), name)
            for name, files in older(results).items()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('names', nargs='*', metavar='NAME')
    parser.add_argument('--list', action='store_true')
    parser.add_argument('--older', action='store_true')
    parser.add_argument('--write', action='store_true')
    parser.add_argument('--check', choices=['page', 'subjects'])
    parser.add_argument('--keep', metavar='FOLDER', help='where all files are written and kept, in a folder for each table; what `rest_states` had judged there is not judged again')
    parser.add_argument('--programs', default=os.path.join(ROOT, 'devel', 'lib', 'soft_robot_lab'))
    arguments = parser.parse_args()
    folder, path = os.path.join(HERE, 'results'), os.path.join(HERE, 'README.md')
    results = stored(folder)
    if arguments.list:
        for table in TABLES:
            print(table.name, results[table.name]['measured'].get('cpu_s', '') if table.name in results else 'not measured')
        return 0
    if arguments.check:
        faults = faults_of_page(results, path) if arguments.check == 'page' else faults_of_subjects(results)
        print('\n'.join(faults))
        return 1 if faults else 0
    names = list(arguments.names) + (sorted(older(results)) if arguments.older else [])
    tables = {table.name: table for table in TABLES}
    if 'all' in names:
        names = list(tables)
    unknown = [name for name in names if name not in tables]
    if unknown or not (names or arguments.write or arguments.older):
        parser.error('no table ' + ', '.join(unknown) if unknown else 'name tables, or see --help')
    failed = 0
    for name in names:  # one that fails does not take the others with it
        try:
            measure(tables[name], arguments.programs, folder, arguments.keep)
            print(name, flush=True)
        except (RuntimeError, ValueError, KeyError, AttributeError, OSError) as error:
            failed += 1
            print('%s: %s: %s' % (name, type(error).__name__, error), file=sys.stderr, flush=True)
    results = stored(folder)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(page.text(TABLES, results, older(results)))
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
