# SPDX-License-Identifier: BSD-3-Clause
"""python3 -m soft_robot_lab.life ROBOT.yaml --output FOLDER: see launch/life.sh."""
import argparse
import fcntl
import os
import sys

import yaml

from . import offline, online, page
from .journal import FAILED, Journal

# name, title, steps that it needs, what it does
STEPS = [
    ('casting', 'Can it be cast?', [], offline.casting),
    ('mould', 'Its mould', [], offline.mould),
    ('fidelity', 'A mesh that is exact enough', [], offline.fidelity),
    ('workspace', 'Where it reaches', ['fidelity'], offline.workspace),
    ('policy', 'A policy', ['workspace'], offline.policy),
    ('path', 'A path', ['workspace'], offline.path),
    ('rig', 'Its emulated rig', ['fidelity'], online.rig),
    ('poses', 'Poses to drive', ['rig'], online.poses),
    ('session', 'Calibration, and a recorded table', ['rig', 'poses'], online.session),
    ('report', 'The report of the recording', ['session'], online.report),
    ('fit', 'The model fitted to the recording', ['poses', 'session'], online.fit),
    ('again', "The fitted robot's policy", ['workspace', 'policy', 'session', 'fit'], online.again),
]


def arguments():
    parser = argparse.ArgumentParser(prog='life.sh', description=__doc__)
    parser.add_argument('robot', metavar='ROBOT', help="a robot's file")
    parser.add_argument('--output', metavar='FOLDER', required=True, help='where everything goes; begun lives go on there')
    given = parser.parse_args()
    try:
        with open(given.robot, encoding='utf-8') as file:
            yaml.safe_load(file)
    except (OSError, ValueError, yaml.YAMLError) as error:
        parser.error('ROBOT: %s' % error)
    return given


def main():
    given = arguments()
    os.makedirs(given.output, exist_ok=True)
    with open(os.path.join(given.output, 'lock'), 'w', encoding='utf-8') as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            sys.exit('life.sh: %s: another life is being lived there' % given.output)
        journal = Journal(given.robot, given.output)
        name = os.path.splitext(os.path.basename(journal.robot))[0]
        titles = {step: title for step, title, _, _ in STEPS}
        for step, _, needs, work in STEPS:
            journal.run(step, needs, work)
            page.write(os.path.join(journal.folder, 'life.html'), name, journal, titles)
    print('page       ' + os.path.join(journal.folder, 'life.html'))
    return 1 if any(outcome.state == FAILED for outcome in journal.outcomes.values()) else 0


if __name__ == '__main__':
    sys.exit(main())
