# SPDX-License-Identifier: BSD-3-Clause
"""The tables of README.md: what measures them, what their subject is, and what is said about them."""
from dataclasses import dataclass, field
from typing import Callable, Dict, List, Optional

import parse_results as parse


@dataclass
class Command:
    words: List[str]  # a program and its arguments; {out}: a folder that is removed afterwards, {root}: the package
    reads: str = ''   # a file in {out}; else what it prints
    label: str = ''


@dataclass
class Table:
    name: str
    section: str
    title: str
    text: str                  # what is compared with what; no measured number
    commands: List[Command]
    parse: Callable
    subject: List[str]         # patterns of files, from the package's folder
    pictures: Dict[str, str] = field(default_factory=dict)  # a file in {out}: its name in config/doc
    columns: Optional[List[str]] = None                     # those that are shown, where not all are
    notes: bool = True


def experiment(name, section, title, text, subject=(), pictures=None, columns=None, notes=True, parser=parse.experiment):
    command = Command(['experiment', name, '--result', '{out}/result.json', '--output', '{out}'], '{out}/result.json')
    return Table(name, section, title, text, [command], parser, ['config/experiments/%s.yaml' % name, *subject],
                 pictures or {}, columns, notes)


def benchmark(name, section, title, text, pattern, names, counters, subject, column='CPU time [ms]', second_ms=None):
    command = Command(['benchmark_soft_robot_lab', '--benchmark_filter=' + pattern, '--benchmark_format=json'])
    return Table(name, section, title, text, [command], parse.google_benchmark(names, counters, column, second_ms), subject)


def found(name, section, title, text, subject=()):
    """An experiment of which the page has what it finds, in a line; the rows are stored alone."""
    return experiment(name, section, title, text, subject, columns=[])


def reference_tests(program, only):
    return Command([program, '--gtest_filter=' + only, '--gtest_output=json:{out}/%s.json' % program], '{out}/%s.json' % program, program)


def robot(name):
    return 'config/robots/%s/robot.yaml' % name


CASTABLE = ['hammerbot', 'spinebot', 'spinebot_castable', 'bubblebot', 'bubblefinger', 'gripper', 'finger_a1', 'finger_a2', 'hanging_bar', 'hollow_cuboid', 'tentacle']
MOULDED = ['hammerbot', 'spinebot', 'bubblebot', 'gripper', 'finger_a1', 'finger_a2', 'hanging_bar']

SPEED = [
    benchmark('speed', 'Speed', 'Cables', 'A simulated second at sixty frames: all cables moving all the time, or one pulled by a fifth and held.',
              'SimulateOneSecond', {'SimulateOneSecond/%s_%s' % (r, m): '%s, %s' % (r.capitalize(), t) for r in ('spinebot', 'hammerbot')
                                    for m, t in (('pull_in_turn', 'all cables moving'), ('pull_and_hold', 'one pulled and held'))},
              {'nodes': 'nodes', 'iterations_per_step': 'linear solves a step',
               'factorisations_per_step': 'factorisations a step', 'not_converged': 'not converged'}, [robot('spinebot'), robot('hammerbot')], second_ms=1e3),
    benchmark('speed_equilibrium', 'Speed', 'Rest states and searches', 'An equilibrium after a pull by a twentieth, and a second of a body that sleeps.',
              'FindEquilibrium|RestOneSecond', {'FindEquilibrium': 'equilibrium of Spinebot', 'RestOneSecond': 'a second of Spinebot asleep'},
              {'nodes': 'nodes'}, [robot('spinebot')]),
    benchmark('speed_parts', 'Speed', 'Parts of a scene', 'What each optional part costs where it is listed: a bar swings for half a second, or settles.',
              'swing/|settle/', {name: name.replace('/', ': ').replace('_', ' ') for name in (
                  'swing/nothing_listed', 'swing/10_markers', 'swing/10_markers_recorded_every_step', 'swing/surface_load', 'swing/slack_cable', 'swing/bdf2',
                  'swing/hollow_nothing_listed', 'swing/hollow_chamber', 'settle/nothing_listed', 'settle/slack_cable', 'settle/pulled_cable',
                  'settle/pulled_cable_with_sensitivity')}, {'iterations': 'iterations'}, ['config/scenes/cantilever.yaml', 'test/data/scenes/hollow_bar.yaml']),
    benchmark('speed_search', 'Speed', 'The demonstration\'s ball', 'Two methods after one another in one process: the ratio of their CPU times.', 'ReachTheBall',
              {'ReachTheBall': 'the demonstration\'s ball'},
              {'start_mm': 'at the start [mm]', 'gauss_newton_mm': '`gauss_newton` [mm]', 'gauss_newton_equilibria': '`gauss_newton`, equilibria', 'gauss_newton_cpu_s': '`gauss_newton`, CPU time [s]',
               'rmsprop_mm': '`rmsprop` [mm]', 'rmsprop_equilibria': '`rmsprop`, equilibria', 'rmsprop_cpu_s': '`rmsprop`, CPU time [s]', 'cpu_ratio': 'ratio of CPU times'},
              [robot('spinebot'), 'config/robots/spinebot/tasks/ball.yaml'], 'both [s]'),
]
REDUCED_ROBOTS = {'Spinebot': ['spinebot', '12', '20', '30'], 'Spinebot that touches itself': ['spinebot/touching', '20', '30'],
                  'Hammerbot, which buckles': ['hammerbot', '20', '30'], 'Bubblebot': ['bubblebot', '20']}
REDUCED = [
    Table('reduced', 'Reduced models', '', '', [Command(['benchmark_reduced', *words], label=label) for label, words in REDUCED_ROBOTS.items()], parse.reduced,
          [robot('spinebot'), 'config/robots/spinebot/touching.yaml', robot('hammerbot'), robot('bubblebot')]),
    Table('rollouts', 'Reduced models', 'Rollouts', 'Spinebot with new random commands again and again, by `newton` and by reduced models of three tolerances; audits as in any run.',
          [Command(['chart_speed_accuracy', '--part', 'rollouts', '--output', '{out}'], '{out}/speed_accuracy.json')],
          parse.chart('rollouts', {'method': 'method', 'threads': 'threads', 'rollouts': 'rollouts', 'rollouts_per_cpu_s': 'rollouts in a CPU-second',
                                   'times_real_time_a_core': 'times real time a core', 'modes': 'modes', 'held_out_rms_mm': 'rms where not trained [mm]',
                                   'training_cpu_s': 'training [CPU-s]', 'left_reduced': 'left the model', 'unsolved': 'unsolved'}),
          ['config/experiments/speed_accuracy.yaml', robot('spinebot')], {'rollouts_per_core.png': 'rollouts_per_core.png'}),
]
REST = [
    experiment('rest_states', 'The same rest state by every way', '', 'Bodies come to rest in time, damped by their mass, which leaves rest states alone. Scenes are drawn at random too: '
               'all loads, commands, obstacles and holds go slowly and in step, and all nodes must end where the equilibrium is, or its warnings must say why not.'),
    found('6.3.3', 'The same rest state by every way', 'The order of pulls', 'Two cables pulled one after the other, in both orders, by equilibria and in time.'),
]
ELEMENTS = [
    experiment('cantilever', 'Elements and materials', 'The cantilever (R1)', 'A bar under its own weight, held at one end, over Poisson\'s ratios: by quadratic and linear elements.',
               ['config/reference/r1_cantilever.csv']),
    found('4.3.2', 'Elements and materials', 'Stiff cables', 'The hanging bar pulled by springs in a row, explicit as the source\'s and implicit, and by sliding cables.'),
    found('via_points', 'Elements and materials', 'Via points of a cable', 'How many points a cable needs that is led through the body.'),
    found('5.3.1', 'Elements and materials', 'Air in the hollow cuboid, compressed', 'On a coarse and a fine mesh, against reference R4.', ['config/reference/r4_chamber.csv']),
    found('5.3.2', 'Elements and materials', 'Air in the hollow cuboid, expanded', 'The same.', ['config/reference/r4_chamber.csv']),
    found('6.3.4', 'Elements and materials', 'Bubblefinger', 'Pumped up, on a coarse and a fine mesh.'),
    found('6.3.5', 'Elements and materials', 'Bubblebot', 'One chamber pumped up, on a coarse and a fine mesh.'),
    found('tentacle', 'Elements and materials', 'A measured tentacle', 'Markers of a real arm with one tendon, against our model at published materials and fitted on every other pose.'),
]
COST = [
    Table('errors', 'Error against CPU time', 'Beside Bullet', 'Each run is one mesh, element and solver; the error is that of the tip or of points along the body, whichever is more. Bullet solves the same linear meshes.',
          [Command(['chart_speed_accuracy', '--part', 'errors', '--output', '{out}'], '{out}/speed_accuracy.json')], parse.experiment,
          ['config/experiments/speed_accuracy.yaml', 'config/reference/*.csv'],
          {name: name for name in ('speed_accuracy_cantilever_0.45.png', 'speed_accuracy_cook_0.49.png', 'speed_accuracy_cable_bar_0.49.png')}, []),
    Table('motion', 'Error against CPU time', 'A robot in motion', 'Spinebot with new random commands: distance of all nodes in all frames from fine steps on the same mesh.',
          [Command(['chart_speed_accuracy', '--part', 'motion', '--output', '{out}'], '{out}/speed_accuracy.json')],
          parse.chart('motion', {'method': 'method', 'steps_a_frame': 'steps a frame', 'substeps': 'substeps', 'cpu_s_per_simulated_s': 'CPU time of a simulated second [s]',
                                 'rms_mm': 'rms [mm]', 'largest_mm': 'largest [mm]', 'rms_beside_newton_with_the_same_steps_mm': 'rms beside `newton` with the same steps [mm]', 'training_cpu_s': 'training [CPU-s]'}),
          ['config/experiments/speed_accuracy.yaml', robot('spinebot')], {'speed_accuracy_motion.png': 'speed_accuracy_motion.png'}),
    Table('nodes', 'Error against CPU time', 'Cost over nodes', 'The cantilever falls for a moment, and comes to rest at once, on one core; powers are by least squares over the finer meshes.',
          [Command(['chart_speed_accuracy', '--part', 'nodes', '--output', '{out}'], '{out}/speed_accuracy.json')], parse.nodes, ['config/scenes/cantilever.yaml']),
    Table('fidelity', 'Error against CPU time', 'What `fidelity` chooses', 'The bank of scenes with true errors and counted costs, `test/data/fidelity_bank.json`, at several tolerances.\n'
          'Regret: cost of the chosen mesh over that of the cheapest one within the tolerance; without luck, of the cheapest from which on none of the finer ones is beyond. Missed: said to be met, but beyond the tolerance. Refused: a mesh would have met it.\n'
          'Near buckling no error is stated, so none is met. Choosing is counted in rest states of the chosen model.',
          [Command(['chart_fidelity', '{root}/test/data/fidelity_bank.json', '{out}'], '{out}/fidelity.json')], parse.fidelity, ['test/data/fidelity_bank.json'],
          {'fidelity.png': 'fidelity.png'}),
    Table('field', 'Error against CPU time', 'Against the field', 'What others published of their own models, on their own machines; none of it was run here, and none states an error at that speed.\n'
          'SOFA\'s bodies have linear elements and are easily compressed; rods have no cross-section that deforms. So no row says that one program is faster at the same error.',
          [Command(['/bin/cat', '{root}/config/experiments/speed_accuracy.yaml'])], parse.published, ['config/experiments/speed_accuracy.yaml']),
]
STABILITY = [
    Table('stability', 'Where methods fail', '', '`chart_stability --quick`: coarse bodies, fewer cases, our solver alone.',
          [Command(['chart_stability', '--quick', '--output', '{out}'], '{out}/stability_quick_cells.csv')], parse.stability,
          [robot('spinebot'), robot('hammerbot'), 'config/scenes/cantilever.yaml', robot('hollow_cuboid')], {'stability_quick.png': 'stability.png'}),
]
CONTACT = [
    Table('contact', 'Contact with obstacles', '', 'Forces, places and times of bodies against rigid obstacles, on the meshes of the ordinary suite.',
          [reference_tests('contact_test', '*Reference*:*Hertz*-*OnAFineMesh*'), reference_tests('friction_test', '*Reference*'), reference_tests('cable_friction_test', '*FindsItsWay*')],
          parse.references, ['test/mechanics/contact/contact_bodies.h'] + ['config/reference/r%s.csv' % name for name in (
              '7_cylinder_on_block_planestrain', '7_sphere_on_disc', '8_beam_on_post_planestrain', '10_friction_block_planestrain', '11_finger_on_cylinder_planestrain',
              '12_drop', '13_capstan')]),
    Table('contact_fine', 'Contact with obstacles', 'On finer meshes', 'The same, on meshes of the nightly suite.', [reference_tests('contact_test', '*OnAFineMesh*')], parse.references,
          ['test/mechanics/contact/contact_bodies.h'] + ['config/reference/r%s.csv' % name for name in (
              '7_sphere_on_disc', '8_beam_on_post_planestrain', '11_finger_on_cylinder_planestrain')]),
    Table('self_contact', 'Self-contact', 'A slot and a clip that close (R9)', 'Forces between their sides. The clip\'s corners touch first.',
          [reference_tests('self_contact_test', '*Reference*')], parse.references,
          ['test/mechanics/contact/contact_bodies.h', 'config/reference/r9_slot_selfcontact.csv', 'config/reference/r9_clip_selfcontact.csv']),
    benchmark('touching', 'Self-contact', 'Spinebot touches itself', 'Pulled from rest to a grid of commands over its range; steps in which skin touches.', 'TouchOverAllCommands',
              {'TouchOverAllCommands': 'over all commands'}, {'times_real_time': 'times real time while touching', 'worst_step_s': 'worst step [s]', 'deepest_um': 'sinks in by at most [um]',
                                                             'not_converged': 'not converged', 'inverted_elements': 'inverted elements'},
              ['config/robots/spinebot/touching.yaml'], 'CPU time [s]'),
    experiment('grasp', 'Gripper', '', 'The gripper closes on a ball, lifts it, and is shaken, at friction about the least that its squeeze needs.', pictures={'grasp.png': 'grasp.png'}),
]
WORKSPACES = [found('workspace_' + name, 'Workspaces', name.capitalize(), 'Each command is reached from hanging.') for name in ('spinebot', 'hammerbot')] + [
    found('6.3.1', 'Workspaces', 'Hammerbot, the source\'s configurations', 'In its order, by sliding cables and by springs.'),
    found('6.3.2', 'Workspaces', 'Spinebot, the source\'s configurations', 'The same.'),
]
POLICIES = [
    experiment('7.3.1', 'Finding policies', 'All methods', 'Random targets for Hammerbot\'s tip, reachable or not; `rmsprop` is the source\'s descent.',
               pictures={'7.3.1_10.png': 'policies_far.png'}, parser=parse.policies),
    found('7.3.2', 'Finding policies', 'PID as published', 'On the same targets, beside `rmsprop`.'),
    found('7.3.3', 'Reaching for a ball', 'The source\'s ball', 'Spinebot reaches for a ball where the source has it.'),
    found('ball', 'Reaching for a ball', 'The demonstration\'s ball', 'Out of reach, and a place within reach.'),
    found('air_policy', 'Reaching for a ball', 'Bubblebot', 'By its syringes, each policy from where the one before has left the robot.'),
]
LEARNED = [
    Table('learned_policy', 'A learned policy', '', '`learn.py` on robots that `random.yaml` draws, tried on others: drawn targets, markers alone, with noise; distances at the end of an episode, as cameras see it, without noise.',
          [Command(['{root}/src/python/examples/learn.py', 'config/tasks/reach_spinebot.yaml', '{out}/policy.npz', '--threads', '2'])], parse.learned, ['config/tasks/reach_spinebot.yaml']),
]
RIG = [found(name, 'Emulated sessions', title, '') for name, title in (
    ('6.4.1', 'Hammerbot'), ('6.4.2', 'Spinebot'), ('6.4.3', 'Bubblebot'))] + [
    found('paths', 'Emulated sessions', 'Paths', 'Tips follow paths on the emulated rig, as commanded and with what earlier rounds showed.',
          ['config/experiments/6.4.%d.yaml' % number for number in (1, 2, 3)]),
    found('fit', 'Fits', 'Stiffness, friction, compliance and lengths', 'Of Spinebot, from poses in their order; the gap on poses that the fit has not seen.'),
    found('fit_rig', 'Fits', 'All that an emulated rig hides', 'One recording of the emulated Spinebot, backlash and creep too.'),
    experiment('twin', 'What pushes a robot', '', 'Emulated robots are pushed at random places of their skin, and carry weights at their markers; a twin that sees markers says where and how much.'),
    found('4.3.1', 'Motor rig', 'Time to pull a cable', 'Beside what the lab measured.'),
    found('rig_faults', 'Motor rig', 'Faults', 'Random commands over a line that corrupts, loses and doubles bytes, with unpluggings, resets and a power cut.'),
    experiment('tracking', 'Tracker', 'A moving robot', 'Spinebot goes through its commands; a post hides markers from one of two cameras.'),
    found('3.3.1', 'Tracker', 'Dark stickers', 'Found by contrast alone, as the source does.'),
    found('3.3.2', 'Tracker', 'A red tip', 'Found by colour.'),
]
CASTING = [
    Table('casting', 'Casting', 'Verdicts', '`check_casting` on the robots of record.',
          [Command(['check_casting', robot(name), '--result', '{out}/%s.json' % name], '{out}/%s.json' % name, name) for name in CASTABLE], parse.casting, [robot(name) for name in CASTABLE]),
    Table('moulds', 'Casting', 'Moulds', '`make_mould`, which verifies what it made: how close volumes close, and how far the cavity is off the skin.',
          [Command(['make_mould', robot(name), '--output', '{out}/' + name], '{out}/%s/mould.json' % name, name) for name in MOULDED], parse.moulds, [robot(name) for name in MOULDED]),
    experiment('demoulding', 'Casting', 'Robots drawn out of their moulds', 'Out of rigid moulds with friction; silicone bears the stretch that the table compares with.'),
    found('design_spinebot', 'Casting', 'Search for a design', 'Numbers of castable Spinebot, so that its tip reaches farther.'),
]
TABLES = SPEED + REDUCED + REST + ELEMENTS + COST + STABILITY + CONTACT + WORKSPACES + POLICIES + LEARNED + RIG + CASTING
