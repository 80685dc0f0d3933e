# SPDX-License-Identifier: BSD-3-Clause
"""The steps that need no session: from casting to a path."""
import csv
import glob
import json
import os

import numpy

from soft_robot_lab import SettingsError, Simulation

from . import drawing
from .journal import Failure, Refusal

TOLERANCE_M = 0.001  # about what cameras see
MAX_NODES = 1500     # two such robots move beside their cameras
SAMPLES = 48         # of the workspace
BLUE, GREY, RED, GREEN, ORANGE = '#5b8fd0', '#b0b0b0', '#d03030', '#2a9d4a', '#e08a20'


def read_json(path):
    with open(path, encoding='utf-8') as file:
        return json.load(file)


def millimetres(position_m):
    return '(%s) mm' % ', '.join('%.1f' % (1e3 * number) for number in position_m)


def model(journal):
    """The robot with the mesh that `fidelity` chose; as it is, where that refused."""
    return journal.outcomes['fidelity'].values.get('model', journal.robot)


def draw(journal, step, name, skins, points):
    with open(journal.path(step, name), 'w', encoding='utf-8') as file:
        file.write(drawing.robots(skins, points))
    journal.current_outcome.pictures.append(name)


def at_rest(path, commands=None):
    """The robot where it rests under these commands."""
    try:
        simulation = Simulation(path)
        if commands:
            simulation.set(commands)
        report = simulation.settle()
    except (SettingsError, RuntimeError) as error:
        raise Refusal(str(error)) from error
    if not report.converged:
        raise Refusal('no rest state was found: ' + report.message)
    return simulation


def skin(name, simulation, colour, nodes_m=None):
    return name, simulation.nodes_m if nodes_m is None else nodes_m, simulation.skin_faces, colour


def casting(journal, outcome):
    journal.program('check_casting', journal.robot, '--result', 'verdict.json', '--page', '.', good=(0, 1))
    outcome.pictures += ['from_above.png', 'from_below.png']
    verdict = read_json(journal.path('casting', 'verdict.json'))
    for name, test in verdict['tests'].items():
        if test['passed'] and 'by' in test:
            outcome.say(name, 'passes in a mould of kind ' + test['by'])
        elif not test['passed']:
            outcome.say(name, test.get('why', 'failed'))
    if not verdict['castable']:
        raise Refusal('it cannot be cast in one block')
    outcome.say('castable', 'along ' + str([round(number, 3) for number in verdict['direction']]))


def mould(journal, outcome):
    """Of one block; else of two halves; else in two pours."""
    for allowed in ((), ('--allow', 'two_part'), ('--allow', 'lid')):
        try:
            journal.program('make_mould', journal.robot, '--output', 'parts', *allowed)
            break
        except Refusal as refusal:
            outcome.say(allowed[1] if allowed else 'one block', str(refusal))
    else:
        raise Refusal('no kind of mould serves')
    outcome.say('kind', allowed[1] if allowed else 'one block')
    made = read_json(journal.path('mould', 'parts', 'mould.json'))
    outcome.say('silicone', '%.1f ml' % (1e6 * made['silicone_volume_m3']) if 'silicone_volume_m3' in made else 'see mould.json')
    outcome.pictures += sorted(os.path.relpath(path, journal.path('mould')) for path in glob.glob(journal.path('mould', 'parts', '*.png')))


def fidelity(journal, outcome):
    """The mesh that is exact enough for a search; later steps take it."""
    asked = journal.path('fidelity', 'asked.yaml')
    robot = os.path.relpath(journal.robot, journal.path('fidelity'))
    _write(asked, 'include: %s\nfidelity: {tolerance_m: %g, use: search, max_nodes: %d}\n' % (json.dumps(robot), TOLERANCE_M, MAX_NODES))
    try:
        journal.program('simulate', 'asked.yaml', '--result', 'result.json', good=(0, 1))
        judged = read_json(journal.path('fidelity', 'result.json'))['fidelity']
        outcome.say('fidelity', judged['sentence'])
        _write(journal.path('fidelity', 'model.yaml'), 'include: %s\n%s' % (json.dumps(robot), judged['choice']))
        outcome.values['model'] = journal.path('fidelity', 'model.yaml')
    except Refusal as refusal:
        outcome.say('no other mesh', str(refusal))
        journal.program('simulate', journal.robot, '--estimate-error', '--result', 'result.json', good=(0, 1))
        outcome.say('as it is', read_json(journal.path('fidelity', 'result.json'))['fidelity']['sentence'])
        outcome.values['model'] = journal.robot
    simulation = at_rest(outcome.values['model'])
    outcome.say('nodes', len(simulation.nodes_m))
    outcome.values['markers'] = list(simulation.marker_names)
    draw(journal, 'fidelity', 'mesh.svg', [skin('at rest', simulation, BLUE)], [(name, place, RED) for name, place in simulation.markers().items()])


def workspace(journal, outcome):
    """Where a marker rests over all commands; a target and a path are taken from there."""
    markers = journal.values('fidelity')['markers']
    if not markers:
        raise Refusal('the robot has no markers, so nothing can be brought anywhere; markers: adds some')
    marker = 'tip' if 'tip' in markers else markers[-1]
    simulation = at_rest(model(journal))
    words = []
    for name, (at_rest_, least, *_) in simulation.limits.items():
        if least < at_rest_:  # beyond rest a cable hangs idle
            words += ['--range', name, least, at_rest_]
    journal.program('workspace', model(journal), '--output', 'tips', '--samples', SAMPLES, '--marker', marker, *words, good=(0, 1))
    with open(journal.path('workspace', 'tips', 'results.csv'), newline='', encoding='utf-8') as file:
        rows = list(csv.DictReader(file))
    outcome.values['marker'] = marker
    tips = reachable(rows, marker)
    if len(tips) < 4:
        raise Refusal('only %d of %d commands have a rest state that does not snap' % (len(tips), len(rows)))
    rest = simulation.markers()[marker]
    tips.sort(key=lambda tip: float(numpy.linalg.norm(tip - rest)))
    far = [float(numpy.linalg.norm(tip - rest)) for tip in tips]
    outcome.say('tips', '%d, the farthest %.1f mm from rest' % (len(tips), 1e3 * far[-1]))
    outcome.values['target_m'] = list(tips[int(0.7 * (len(tips) - 1))])
    outcome.values['path_m'] = [list(tips[int(part * (len(tips) - 1))]) for part in (0.3, 0.55, 0.8)]
    draw(journal, 'workspace', 'tips.svg', [skin('at rest', simulation, BLUE)],
         [('where %s rests' % marker, tip, GREEN) for tip in tips] + [('target', outcome.values['target_m'], RED)])


def reachable(rows, marker):
    """Where the marker rests, without commands that failed, snapped or folded."""
    columns = ['markers.%s.position_m.%s' % (marker, axis) for axis in 'xyz']
    good = [row for row in rows if row['state'] == 'good' and 'true' not in (row['snapped'], row['folded'])]
    return [numpy.array([float(row[column]) for column in columns]) for row in good]


def policy(journal, outcome):
    search(journal, outcome, 'policy', model(journal), [journal.values('workspace')['target_m']])


def path(journal, outcome):
    search(journal, outcome, 'path', model(journal), journal.values('workspace')['path_m'])


def search(journal, outcome, step, robot, targets_m):
    """The commands that bring the marker to one place after another."""
    marker = journal.values('workspace')['marker']
    words = []
    for target_m in targets_m:
        words += (['--then'] if words else []) + ['--marker', marker, '--target'] + ['%.6f' % number for number in target_m]
    journal.program('optimise', robot, *words, '--policy', 'policy.yaml', '--result', 'answer.json', good=(0, 1))
    answer = read_json(journal.path(step, 'answer.json'))
    for target_m, pose in zip(targets_m, answer['poses']):
        outcome.say('to ' + millimetres(target_m), '%.3f mm off, after %.3f mm before; %s' %
                    (1e3 * pose['final_distance_m'], 1e3 * pose['initial_distance_m'], pose['stop_reason']))
    if not os.path.exists(journal.path(step, 'policy.yaml')):
        raise Refusal(answer['poses'][-1]['stop_reason'])
    names, steps = answer['policy']['names'], answer['policy']['steps']
    outcome.values.update(policy=journal.path(step, 'policy.yaml'), names=names, steps=steps)
    simulation = at_rest(robot, dict(zip(names, steps[-1]['values'])))
    outcome.say('last commands', ', '.join('%s %.4g' % pair for pair in zip(names, steps[-1]['values'])))
    draw(journal, step, 'reached.svg', [skin('before', simulation, GREY, simulation.rest_nodes_m), skin('at the end', simulation, BLUE)],
         [('target', target_m, RED) for target_m in targets_m] + [(marker, simulation.markers()[marker], GREEN)])


def _write(path_, text):
    with open(path_, 'w', encoding='utf-8') as file:
        file.write(text)
