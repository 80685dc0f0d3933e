#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""learn.py TASK.yaml POLICY.npz: trains a small network to reach for targets, on robots that are drawn, and tries it on others.

First it imitates: where a robot rests under drawn commands, these commands are what `optimise` on that robot answers to a target at that
place. Then a population of networks around it tries itself in the VectorEnvironment, and moves to where rewards are (evolution strategies,
Salimans et al. 2017). Beside it stands `optimise` by gauss_newton on the robot as its file has it, whose commands do not see what the drawn
robot does. It needs NumPy alone, and repeats itself for an equal --seed where BLAS has one thread."""
import argparse
import time

import numpy

import soft_robot_lab
from soft_robot_lab import learned_policy


def episode_steps(environment):
    return max(1, round(environment.settings['episode_s'] * environment.settings['control_rate_hz']))


def wander(environment, rounds, draw):
    """Episodes that go to drawn commands and stay there. Of each robot the observations on the way, and those at the end."""
    ways, ends, steps = {}, {}, episode_steps(environment)
    change = environment.settings['largest_change']
    for _ in range(rounds):
        seen, info = environment.reset(seed=int(draw.integers(1 << 31)))
        wish, passed, running = draw.uniform(-1, 1, environment.action_space.shape), [], numpy.ones(environment.num_envs, dtype=bool)
        for step in range(steps):
            passed.append(seen)
            seen, _, _, ended, now = environment.step((wish - seen[:, -wish.shape[1]:]) / (2 * change))
            running &= ~ended | (step == steps - 1)
        for world in numpy.flatnonzero(running & now['final_info']['converged']):
            ways.setdefault(info['plant'][world], []).extend(one[world] for one in passed)
            ends.setdefault(info['plant'][world], []).append(now['final_obs'][world])
    return [(numpy.array(ways[plant]), numpy.array(ends[plant])) for plant in sorted(ends)]


def first_policy(environment, wandered, hidden, draw):
    names, settings = environment.batch.actuator_names, environment.settings
    inputs = numpy.concatenate([ways for ways, _ in wandered])
    marker = environment.batch.marker_names.index(settings['marker'])
    markers = 3 * len(environment.batch.marker_names)
    inputs[:, markers:markers + 3] = inputs[:, 3 * marker:3 * marker + 3]
    widths = [inputs.shape[1]] + list(hidden) + [3 * len(names)]
    arrays = {
        'format': 1, 'actuators': names, 'markers': environment.batch.marker_names, 'marker': marker,
        'control_rate_hz': settings['control_rate_hz'], 'largest_change': settings['largest_change'],
        'limits': [settings['limits'][name] for name in names], 'unit_m': 0.01,
        'inputs_mean': inputs.mean(axis=0), 'inputs_deviation': inputs.std(axis=0) + 1e-3}
    for i, (before, after) in enumerate(zip(widths, widths[1:])):
        arrays['weights_%d' % i] = draw.normal(size=(before, after)) / numpy.sqrt(before)
        arrays['biases_%d' % i] = numpy.zeros(after)
    return soft_robot_lab.LearnedPolicy({name: numpy.array(array) for name, array in arrays.items()})


def with_layers(policy, layers):
    arrays = dict(policy.arrays)
    for i, (weights, biases) in enumerate(layers):
        arrays['weights_%d' % i], arrays['biases_%d' % i] = weights, biases
    return soft_robot_lab.LearnedPolicy(arrays)


class Adam:
    """Kingma and Ba 2015."""

    def __init__(self, sizes, rate):
        self.rate, self.count = rate, 0
        self.mean, self.square = [numpy.zeros(size) for size in sizes], [numpy.zeros(size) for size in sizes]

    def step(self, parameters, gradients, share=1.0):
        self.count += 1
        for i, gradient in enumerate(gradients):
            self.mean[i] += 0.1 * (gradient - self.mean[i])
            self.square[i] += 0.001 * (gradient ** 2 - self.square[i])
            mean, square = self.mean[i] / (1 - 0.9 ** self.count), self.square[i] / (1 - 0.999 ** self.count)
            parameters[i] -= share * self.rate * mean / (numpy.sqrt(square) + 1e-8)


def pairs(policy, wandered, count, pace, draw):
    """Observations, and the actions that lead to where other episodes of the same robots ended."""
    markers, actuators, at = 3 * len(policy.markers), len(policy.actuators), 3 * policy.marker
    observations, wishes = [], []
    for robot in draw.integers(len(wandered), size=count // 64):
        ways, ends = wandered[robot]
        start, end = ways[draw.integers(len(ways), size=64)], ends[draw.integers(len(ends), size=64)]
        start[:, markers:markers + 3] = end[:, at:at + 3]
        observations.append(start)
        wishes.append((end - start)[:, -actuators:] * pace / (2 * policy.largest_change))
    return numpy.concatenate(observations), numpy.concatenate(wishes)


def slopes_of(parameters, observations, wishes, policy):
    """Gradients of half the mean square that actions miss their wishes by, and that mean square."""
    values = [learned_policy.inputs(observations, policy)]
    for i in range(0, len(parameters), 2):
        value = values[-1] @ parameters[i] + parameters[i + 1]
        values.append(numpy.tanh(value) if i + 2 < len(parameters) else value)
    ways = learned_policy.ways(observations, policy)[:, None, :]
    action = (values[-1].reshape(len(ways), -1, 3) * ways).sum(axis=-1)
    near = numpy.minimum(1.0, 5.0 * numpy.sqrt((ways ** 2).sum(axis=-1)))  # slack cables have many commands at one place
    wishes = numpy.clip(wishes, -1.0, 1.0)
    miss = near * numpy.where((abs(wishes) >= 1) & (action * wishes >= 1), 0.0, action - wishes)  # beyond its end it is cut off
    back, gradients = (near * miss)[:, :, None] * ways / len(ways), [None] * len(parameters)
    back = back.reshape(len(ways), -1)
    for i in range(len(parameters) - 2, -1, -2):
        gradients[i], gradients[i + 1] = values[i // 2].T @ back, back.sum(axis=0)
        back = (back @ parameters[i].T) * (1 - values[i // 2] ** 2)
    return gradients, (miss ** 2).mean()


def imitate(policy, wandered, rounds, pace, draw):
    """Least squares of actions that go `pace` of the way to the commands of optimise in each step."""
    parameters = [numpy.array(array) for layer in policy.layers for array in layer]
    adam, losses = Adam([array.shape for array in parameters], 3e-3), []
    for count in range(rounds):
        observations, wishes = pairs(policy, wandered, 512, pace, draw)
        gradients, loss = slopes_of(parameters, observations, wishes, policy)
        adam.step(parameters, gradients, 1.0 - count / rounds)
        losses.append(loss)
    return with_layers(policy, list(zip(parameters[::2], parameters[1::2]))), float(numpy.mean(losses[-max(1, rounds // 10):]))


def tried(environment, layers, policy, seeds):
    """(networks,) mean rewards of a step, over an episode for each seed; the same robots and targets for all networks."""
    networks, worst = len(layers[0][0]), -environment.settings['distance_per_m'] * 0.1
    seen, _ = environment.reset(seed=[int(seed) for seed in seeds] * networks)
    total, running = numpy.zeros(environment.num_envs), numpy.ones(environment.num_envs, dtype=bool)
    for _ in range(episode_steps(environment)):
        acted = learned_policy.actions(layers, seen.reshape(networks, len(seeds), -1), policy)
        seen, rewards, _, ended, _ = environment.step(acted.reshape(environment.num_envs, -1))
        total += numpy.where(running, rewards, worst)
        running &= ~ended
    return total.reshape(networks, len(seeds)).mean(axis=1) / episode_steps(environment)


def evolve(environment, policy, generations, networks, draw):
    """Evolution strategies with mirrored networks and ranks."""
    parameters = [numpy.array(array) for layer in policy.layers for array in layer]
    widths = [0.05 * numpy.sqrt((policy.layers[i // 2][0] ** 2).mean()) for i in range(len(parameters))]
    adam, half, said = Adam([array.shape for array in parameters], 1.0), networks // 2, []
    for generation in range(generations):
        noise = [draw.normal(size=(half,) + array.shape) for array in parameters]
        several = [array + width * numpy.concatenate([one, -one]) for array, width, one in zip(parameters, widths, noise)]
        seeds = draw.integers(1 << 31, size=environment.num_envs // networks)
        rewards = tried(environment, list(zip(several[::2], several[1::2])), policy, seeds)
        said.append(rewards.mean())
        ranks = rewards.argsort().argsort() / (networks - 1) - 0.5
        slopes = [numpy.tensordot(ranks[:half] - ranks[half:], one, 1) / half for one in noise]
        steps = [numpy.zeros_like(array) for array in parameters]
        adam.step(steps, [-slope for slope in slopes], 1.0 - 0.9 * generation / generations)
        parameters = [array + 0.3 * width * step for array, width, step in zip(parameters, widths, steps)]
    return with_layers(policy, list(zip(parameters[::2], parameters[1::2]))), said


def train(environment, effort=1.0, networks=16, hidden=(32, 32), pace=0.3, seed=1):
    """`environment`: a VectorEnvironment whose actions are changes; `effort` multiplies all rounds; `networks` of a generation share its worlds.
    Returns a LearnedPolicy, and a dict of numbers about its training."""
    if environment.settings['task'] != 'reach' or environment.settings['observation'] != 'markers' or environment.settings['action'] != 'change':
        raise ValueError('the task must be to reach, by markers alone, and actions changes of the commands')
    draw = numpy.random.default_rng(seed)
    times_s = [time.process_time()]
    wandered = wander(environment, max(1, round(30 * effort)), draw)
    times_s.append(time.process_time())
    policy, loss = imitate(first_policy(environment, wandered, hidden, draw), wandered, max(1, round(6000 * effort)), pace, draw)
    times_s.append(time.process_time())
    policy, rewards = evolve(environment, policy, max(1, round(200 * effort)), networks, draw)
    times_s.append(time.process_time())
    return policy, {'loss': loss, 'rewards': rewards, 'cpu_s': numpy.diff(times_s).tolist()}


def final_distances_m(environment, targets_m, act):
    """(targets, robots) distances at the end of episodes, without noise; `act` has observations and numbers of targets."""
    robots = environment.robots
    every = [(target, robot) for target in range(len(targets_m)) for robot in range(robots)]
    found_m = numpy.full((len(targets_m), robots), numpy.inf)
    for first in range(0, len(every), environment.num_envs):
        some = every[first:first + environment.num_envs]
        some += some[-1:] * (environment.num_envs - len(some))
        targets, plants = numpy.array(some).T
        seen, _ = environment.reset(seed=first, options={'plant': plants, 'target_m': targets_m[targets]})
        last_m, running = numpy.full(len(some), numpy.inf), numpy.ones(len(some), dtype=bool)
        for _ in range(episode_steps(environment)):
            seen, _, _, ended, info = environment.step(act(seen, targets))
            if ended.any():
                end = info['final_info']
                good = ended & running & end['converged']
                last_m[good] = end['distance_m'][good]
                running &= ~ended
        found_m[targets, plants] = last_m
    return found_m


def open_loop(environment, targets_m):
    """(targets, actuators) commands of gauss_newton for the robot as its file has it, from -1 to 1 over their ranges."""
    settings = environment.settings
    low, high = numpy.array([settings['limits'][name] for name in environment.batch.actuator_names]).T
    commands = []
    for target_m in targets_m:
        answer = soft_robot_lab.optimise(settings['robot'], {settings['marker']: target_m})
        commands.append(numpy.clip(answer['poses'][0]['commands'], low, high))
    return (2 * numpy.array(commands) - (low + high)) / (high - low)


def summary(name, distances_m):
    """Of (targets, robots)."""
    mm = 1e3 * distances_m.ravel()
    return '%s: median %.2f mm, 90 %% within %.2f mm, largest %.2f mm; %.0f %% within 1.5 mm' % (
        name, numpy.median(mm), numpy.quantile(mm, 0.9), mm.max(), 100 * (mm <= 1.5).mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('task')
    parser.add_argument('policy', help='the .npz file that is written')
    parser.add_argument('--worlds', type=int, default=64)
    parser.add_argument('--threads', type=int)
    parser.add_argument('--effort', type=float, default=1.0, help='multiplies all rounds of training')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--robots', type=int, default=20, help='other ones, on which it is tried')
    parser.add_argument('--targets', type=int, default=50)
    arguments = parser.parse_args()
    begin_s, cpu_s = time.monotonic(), time.process_time()
    environment = soft_robot_lab.VectorEnvironment(arguments.task, arguments.worlds, arguments.threads)
    print('%.0f s for its robots' % (time.monotonic() - begin_s), flush=True)
    policy, about = train(environment, arguments.effort, seed=arguments.seed)
    policy.save(arguments.policy)
    print('trained in %.0f s, %.0f CPU-s (of which %.0f wandering, %.0f imitating, %.0f evolving); rewards of a step from %.3f to %.3f' % (
        time.monotonic() - begin_s, time.process_time() - cpu_s, *about['cpu_s'], numpy.mean(about['rewards'][:10]), numpy.mean(about['rewards'][-10:])), flush=True)
    others = soft_robot_lab.VectorEnvironment(arguments.task, arguments.worlds, arguments.threads, {
        'seed': arguments.seed + 1, 'targets.reachable': arguments.targets,
        'randomisation.seed': arguments.seed + 1, 'randomisation.samples': arguments.robots})
    targets_m = others.settings['targets']['points_m']
    print(summary('learned', final_distances_m(others, targets_m, lambda seen, _: policy.actions(seen))), flush=True)
    wishes, change = open_loop(others, targets_m), others.settings['largest_change']
    print(summary('gauss_newton, open loop', final_distances_m(
        others, targets_m, lambda seen, targets: (wishes[targets] - seen[:, -wishes.shape[1]:]) / (2 * change))))


if __name__ == '__main__':
    main()
