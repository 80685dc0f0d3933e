# SPDX-License-Identifier: BSD-3-Clause
"""What each step of a robot's life did, kept in its folder, so that a step that is done is not done again."""
import hashlib
import json
import os
import resource
import shutil
import subprocess
import time

import yaml

DONE, REFUSED, LEFT_OUT, FAILED = 'done', 'refused', 'left out', 'failed'


class Refusal(Exception):
    """A program refuses, in its own words."""


class Failure(Exception):
    """A step broke down, and is tried again by the next run."""


class Outcome:
    """says: (name, text) for the page. values: what later steps need. pictures: files below the step's folder."""

    def __init__(self, state=DONE, why=''):
        self.state, self.why = state, why
        self.says, self.values, self.pictures, self.commands = [], {}, [], []
        self.wall_s = self.cpu_s = 0.0

    def say(self, name, text):
        self.says.append([name, str(text)])


def hash_of_files(path, seen=None):
    """Of a settings file and of all files that it names, wherever these lie."""
    seen = {} if seen is None else seen
    path = os.path.realpath(path)
    if path in seen:
        return seen
    with open(path, 'rb') as file:
        content = file.read()
    seen[path] = hashlib.sha256(content).hexdigest()
    if path.endswith(('.yaml', '.yml')):
        for text in _texts(yaml.safe_load(content)):
            named = os.path.join(os.path.dirname(path), text)
            if os.path.isfile(named):
                hash_of_files(named, seen)
    return seen


def _texts(node):
    if isinstance(node, str):
        yield node
    elif isinstance(node, dict):
        for child in node.values():
            yield from _texts(child)
    elif isinstance(node, list):
        for child in node:
            yield from _texts(child)


class Journal:
    """The folder of one life. Steps are run in order; each has a folder of its own and a file `step.json` once it is done or refused."""

    def __init__(self, robot, folder):
        self.robot, self.folder = os.path.realpath(robot), os.path.abspath(folder)
        self.outcomes, self._keys = {}, {}
        self._robot_key = sorted(hash_of_files(self.robot).items())
        self._current = None

    @property
    def current_outcome(self):
        """Of the step that runs."""
        return self._current[1]

    def path(self, step, *names):
        return os.path.join(self.folder, step, *names)

    def values(self, step):
        return self.outcomes[step].values

    def run(self, step, needs, work):
        """`work(journal, outcome)` fills the outcome. Left out where a step that it needs came to nothing."""
        key = self._key(step, needs)
        kept = self._kept(step, key)
        outcome = kept or self._make(step, needs, work)
        self.outcomes[step] = outcome
        print('%-10s %s%s%s' % (step, outcome.state, ', as before' if kept else '', ': ' + outcome.why if outcome.why else ''), flush=True)
        if not kept and outcome.state in (DONE, REFUSED):
            self._keep(step, key, outcome)

    def program(self, *words, good=(0,)):
        """Runs a program of this package in the step's folder; returns its standard output. Refusal where it ends otherwise."""
        step, outcome = self._current
        command = ['rosrun', 'soft_robot_lab'] + [str(word) for word in words]
        outcome.commands.append(' '.join(command))
        done = subprocess.run(command, cwd=self.path(step), stdin=subprocess.DEVNULL, capture_output=True, text=True, errors='replace', check=False)
        with open(self.path(step, 'log.txt'), 'a', encoding='utf-8') as log:
            log.write('%s\n%s%s\n' % (outcome.commands[-1], done.stdout, done.stderr))
        if done.returncode < 0:
            raise Failure('%s was ended by signal %d' % (words[0], -done.returncode))
        if done.returncode not in good:
            raise Refusal(last_words(done.stderr) or last_words(done.stdout) or '%s ended with %d' % (words[0], done.returncode))
        return done.stdout

    def _make(self, step, needs, work):
        missing = [name for name in needs if self.outcomes[name].state != DONE]
        if missing:
            return Outcome(LEFT_OUT, 'it needs the step ' + ' and the step '.join(missing))
        shutil.rmtree(self.path(step), ignore_errors=True)
        os.makedirs(self.path(step))
        outcome = Outcome()
        self._current = (step, outcome)
        wall_s, cpu_s = time.monotonic(), _cpu_s()
        try:
            work(self, outcome)
        except Refusal as refusal:
            outcome.state, outcome.why = REFUSED, str(refusal)
        except Failure as failure:
            outcome.state, outcome.why = FAILED, str(failure)
        outcome.wall_s, outcome.cpu_s = time.monotonic() - wall_s, _cpu_s() - cpu_s
        return outcome

    def _key(self, step, needs):
        text = json.dumps([step, self._robot_key, [self._keys[name] for name in needs]])
        self._keys[step] = hashlib.sha256(text.encode()).hexdigest()
        return self._keys[step]

    def _kept(self, step, key):
        try:
            with open(self.path(step, 'step.json'), encoding='utf-8') as file:
                kept = json.load(file)
        except (OSError, ValueError):
            return None
        if kept.pop('key', None) != key:
            return None
        outcome = Outcome()
        outcome.__dict__.update(kept)
        return outcome

    def _keep(self, step, key, outcome):
        part = self.path(step, 'step.json.part')
        with open(part, 'w', encoding='utf-8') as file:
            json.dump(dict(outcome.__dict__, key=key), file, indent=2)
        os.replace(part, self.path(step, 'step.json'))


def last_words(text):
    """Of what a program printed: its last lines, without its bar."""
    lines = [line.split('\r')[-1].strip() for line in text.split('\n')]  # splitlines() cuts at \r too
    return ' '.join([line for line in lines if line and 'warning:' not in line][-3:])


def _cpu_s():
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
