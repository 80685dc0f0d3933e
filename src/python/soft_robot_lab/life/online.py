# SPDX-License-Identifier: BSD-3-Clause
"""The steps on the emulated rig: from its files to the fitted robot's policy."""
import glob
import json
import os
import shlex
import subprocess
import sys

import yaml

from . import drawing
from .journal import Failure, last_words
from .offline import BLUE, GREEN, ORANGE, RED, at_rest, draw, model, read_json, search, skin

POSES = 8      # of the table
HOLD_S = 4.0   # each, as silicone creeps


def rig(journal, outcome):
    """Its files, and the arguments of the session that `new_rig` names."""
    said = journal.program('new_rig', model(journal), '--output', 'files')
    command = next(line for line in said.splitlines() if line.startswith('an emulated session')).split('session', 1)[1]
    words = [word for word in shlex.split(command) if ':=' in word]
    outcome.values['arguments'] = dict(word.split(':=', 1) for word in words)
    outcome.commands.append(command.strip())
    with open(journal.path('rig', 'log.txt'), encoding='utf-8') as log:
        for line in log:
            if 'warning: ' in line:
                outcome.say('warning', line.split('warning: ', 1)[1].strip())
    outcome.say('files', ', '.join(sorted(os.listdir(journal.path('rig', 'files')))))
    balls = _balls(journal.path('rig', 'files', 'balls.yaml'))
    simulation = at_rest(model(journal))
    draw(journal, 'rig', 'balls.svg', [skin('robot', simulation, BLUE)],
         [('marker', place, RED) for place in simulation.markers().values()] + [('ball', ball, ORANGE) for ball in balls])


def _balls(path):
    with open(path, encoding='utf-8') as file:
        return [ball['position_m'] for ball in yaml.safe_load(file)['balls']]


def parameters(journal):
    """What a fit looks for: cables command lengths, so theirs matter too."""
    cables = at_rest(model(journal)).tensions_n()
    return 'youngs_modulus_pa,compliance_m_n,length_offset_m,backlash_m' if cables else 'youngs_modulus_pa'


def poses(journal, outcome):
    """Which to drive, so that the fit will be sure."""
    outcome.values['parameters'] = parameters(journal)
    said = journal.program('propose_poses', model(journal), '--parameters', outcome.values['parameters'], '--poses', POSES, '--output', 'table.yaml')
    for line in said.splitlines():
        name, _, text = line.partition(' = ')
        outcome.say(name, text)
    outcome.values['table'] = journal.path('poses', 'table.yaml')
    _draw_poses(journal, outcome)


def _draw_poses(journal, outcome):
    with open(outcome.values['table'], encoding='utf-8') as file:
        table = yaml.safe_load(file)['configurations']
    simulation = at_rest(model(journal))
    skins = [skin('at rest', simulation, BLUE)]
    points = []
    for configuration in table:
        simulation = at_rest(model(journal), dict(zip(simulation.actuator_names, configuration['commands'])))
        points += [('markers at the poses', place, GREEN) for place in simulation.markers().values()]
    draw(journal, 'poses', 'poses.svg', skins, points)


def session(journal, outcome):
    """Cameras calibrated, the table driven and recorded."""
    folder = journal.path('session')
    arguments = dict(journal.values('rig')['arguments'], record=True, bag_folder=folder)
    arguments.setdefault('camera_poses', os.path.join(folder, 'camera_poses.yaml'))
    answer = _lab(journal, 'session', {'arguments': arguments, 'calibrate': True, 'table': journal.values('poses')['table'], 'hold_s': HOLD_S})
    for camera, residual_m in answer['calibration'].items():
        outcome.say('calibration of ' + camera, 'balls miss their places by %.2f mm' % (1e3 * residual_m))
    for line in answer['table'].splitlines()[1:]:
        outcome.say(line.split()[0], line.split(None, 1)[1])
    bags = glob.glob(os.path.join(folder, '*.bag'))
    if len(bags) != 1:
        raise Failure('%d whole recordings in %s' % (len(bags), folder))
    outcome.values.update(bag=bags[0], arguments=arguments)


def _lab(journal, step, request):
    """One session; its words where it fails."""
    request.update(answer=journal.path(step, 'answer.json'), picture=journal.path(step, 'seen.png'))
    request_file = journal.path(step, 'request.json')
    with open(request_file, 'w', encoding='utf-8') as file:
        json.dump(request, file, indent=2)
    environment = dict(os.environ, ROS_LOG_DIR=journal.path(step, 'ros'))
    with open(journal.path(step, 'session.log'), 'w', encoding='utf-8') as log:
        done = subprocess.run([sys.executable, '-m', 'soft_robot_lab.life.lab', request_file], stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                              env=environment, check=False)
    if done.returncode:
        with open(journal.path(step, 'session.log'), encoding='utf-8', errors='replace') as log:
            raise Failure(last_words(log.read()) or 'the session ended with %d' % done.returncode)
    journal.current_outcome.pictures.append('seen.png')
    return read_json(request['answer'])


def report(journal, outcome):
    journal.program('report', journal.values('session')['bag'], '--output', 'report')
    outcome.say('page', 'report/report.html')
    outcome.pictures += sorted(os.path.relpath(path, journal.path('report')) for path in glob.glob(journal.path('report', 'report', '*.svg')))[:3]


def fit(journal, outcome):
    names = journal.values('poses')['parameters']
    journal.program('fit_model', journal.values('session')['bag'], '--parameters', names, '--output', 'fitted.yaml', '--result', 'fit.json')
    fitted = read_json(journal.path('fit', 'fit.json'))
    for name, value in fitted['values'].items():
        outcome.say(name, '%.5g, was %.5g; 95 %%: %.5g to %.5g%s' %
                    (value['value'], value['start'], value['low'], value['high'], '' if value['identifiable'] else '; not identifiable'))
    for warning in fitted['warnings']:
        outcome.say('warning', warning)
    rows = []
    for when, colour in (('before', RED), ('after', GREEN)):
        rows.append(('all, %s the fit' % when, 1e3 * fitted[when]['rms_m'], colour))
        rows += [('%s, %s' % (marker, when), 1e3 * gap_m, colour) for marker, gap_m in fitted[when]['markers'].items()]
    _bars(journal, 'fit', 'gap.svg', 'Gap between cameras and model, rms', rows)
    outcome.say('gap', '%.2f mm before, %.2f mm after' % (1e3 * fitted['before']['rms_m'], 1e3 * fitted['after']['rms_m']))
    outcome.values['scene'] = journal.path('fit', 'fitted.yaml')


def _bars(journal, step, name, title, rows):
    with open(journal.path(step, name), 'w', encoding='utf-8') as file:
        file.write(drawing.bars(title, rows, 'mm'))
    journal.current_outcome.pictures.append(name)


def again(journal, outcome):
    """The fitted robot's policy, and on the rig both: how near they come."""
    target_m, marker = journal.values('workspace')['target_m'], journal.values('workspace')['marker']
    search(journal, outcome, 'again', journal.values('fit')['scene'], [target_m])
    policies = [dict(name=name, marker=marker, target_m=target_m, names=values['names'], steps=values['steps'])
                for name, values in (('of the model', journal.values('policy')), ('of the fitted model', outcome.values))]
    arguments = dict(journal.values('session')['arguments'], scene=journal.values('fit')['scene'], record=False)
    answer = _lab(journal, 'again', {'arguments': arguments, 'policies': policies})
    for name, played in answer['policies'].items():
        outcome.say('policy ' + name, 'on the rig %.2f mm off' % (1e3 * played['off_m']))
    outcome.values['off_m'] = {name: played['off_m'] for name, played in answer['policies'].items()}
    _bars(journal, 'again', 'distances.svg', 'How far the policies end from the target, as tracked on the rig',
          [(name, 1e3 * played['off_m'], colour) for (name, played), colour in zip(answer['policies'].items(), (RED, GREEN))])
