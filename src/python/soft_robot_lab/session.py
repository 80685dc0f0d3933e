# SPDX-License-Identifier: BSD-3-Clause
"""A client of a session's topics and services. Lengths are in metres, in the frame robot_base; times are the session's, in seconds."""
import collections
import os
import signal
import subprocess
import threading
import time
import xmlrpc.client

import actionlib
import numpy
import rosgraph
import rospy
from geometry_msgs.msg import Point
from std_srvs.srv import Trigger

from soft_robot_lab.msg import (ActuatorCommand, ActuatorRanges, ActuatorState, FollowPathAction, FollowPathGoal, MarkerObservations, Policy,
                                PolicyStep)
from soft_robot_lab.srv import ExecutePolicy, ExecutePolicyRequest, LoadScene, OptimisePolicy, OptimisePolicyRequest, UseSolver


class SessionError(RuntimeError):
    """What the session refused, in its own words; or no session answers."""


# time_s: n. markers_m: by name, n x 3. commands: by actuator, n, at the same times; nan before the first was heard.
Recording = collections.namedtuple('Recording', 'time_s markers_m commands')


class Session:
    """One running session. `Session()` joins the one that runs, `Session.start(...)` begins one and ends it with `close()`."""

    def __init__(self, namespace='', wait_s=60.0):
        if not rosgraph.is_master_online():
            raise SessionError('no ROS master answers; start a session, or use Session.start')
        if not rospy.core.is_initialized():
            rospy.init_node('session_client', anonymous=True, disable_signals=True)
        self._prefix = '/' + namespace.strip('/') + '/' if namespace.strip('/') else '/'
        self._process = None
        self._changed = threading.Condition()
        self._markers = {'simulator': None, 'tracker': None}
        self._state = self._ranges = self._recorded = None
        self._commands = rospy.Publisher(self._prefix + 'actuators/command', ActuatorCommand, queue_size=100)
        self._subscribers = [
            rospy.Subscriber(self._prefix + 'simulator/actuators', ActuatorState, self._on_state),
            rospy.Subscriber(self._prefix + 'simulator/actuator_ranges', ActuatorRanges, self._on_ranges),
            rospy.Subscriber(self._prefix + 'simulator/markers', MarkerObservations, self._on_markers, 'simulator'),
            rospy.Subscriber(self._prefix + 'tracker/markers', MarkerObservations, self._on_markers, 'tracker')]
        self._wait(lambda: self._state and self._ranges and self._markers['simulator'], wait_s,
                   'no session publishes below ' + self._prefix)
        self._wait_for_links(wait_s)

    @classmethod
    def start(cls, robot=None, scene=None, wait_s=120.0, **arguments):
        """Begins a session with arguments of session.launch: Session.start('spinebot', rviz=True). Without `rviz` there is no window."""
        if rosgraph.is_master_online() and any(node.endswith('/simulator') for node in _nodes()):
            raise SessionError('a session runs already; Session() joins it')
        given = dict(arguments, **{name: value for name, value in (('robot', robot), ('scene', scene)) if value})
        given.setdefault('rviz', False)
        words = ['%s:=%s' % (name, str(value).lower() if isinstance(value, bool) else value) for name, value in given.items()]
        process = subprocess.Popen(['roslaunch', 'soft_robot_lab', 'session.launch'] + words, stdout=subprocess.DEVNULL)
        end_s = time.monotonic() + wait_s
        while not rosgraph.is_master_online() or '/simulator' not in _nodes():
            if process.poll() is not None or time.monotonic() > end_s:
                _end(process)
                raise SessionError('the session did not start: roslaunch soft_robot_lab session.launch ' + ' '.join(words))
            time.sleep(0.1)
        try:
            session = cls(wait_s=wait_s)
        except SessionError:
            _end(process)
            raise
        session._process = process
        return session

    def close(self):
        """Ends the session, if this object began it."""
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._commands.unregister()
        if self._process:
            _end(self._process)
        self._process = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    @property
    def actuators(self):
        """The commands that each takes: {name: (rest, least, most, unit)}."""
        ranges = self._ranges
        return dict(zip(ranges.names, zip(ranges.rests, ranges.mins, ranges.maxs, ranges.units)))

    @property
    def commands(self):
        """As last asked for: {name: value}."""
        return dict(zip(self._state.names, self._state.commands))

    @property
    def tensions_n(self):
        return {cable.name: cable.tension_n for cable in self._state.cables}

    def move(self, wait_s=5.0, **values):
        """Commands actuators by name, and waits until the simulator has taken them: move(left=0.9)."""
        for name, value in values.items():
            if name not in self.actuators:
                raise SessionError("no actuator '%s'; there are: %s" % (name, ', '.join(self.actuators)))
            _, least, most, unit = self.actuators[name]
            if not least <= value <= most:
                raise SessionError('%s: %g is not in [%g, %g] %s' % (name, value, least, most, unit))
        command = ActuatorCommand(names=list(values), values=[float(value) for value in values.values()])
        command.header.stamp = rospy.Time.now()
        self._commands.publish(command)
        self._wait(lambda: all(self.commands.get(name) == value for name, value in values.items()), wait_s,
                   'the simulator does not take the command')

    def markers(self, source='simulator'):
        """Where they are now: {name: array of 3}. `source`: simulator, or tracker."""
        message = self._markers[source]
        if message is None:
            raise SessionError('no markers of the %s were heard' % source)
        return {name: numpy.array([p.x, p.y, p.z]) for name, p in zip(message.names, message.positions)}

    def optimise(self, marker, target_m, method='gauss_newton', **fields):
        """Finds commands that bring the marker to a place; the answer of OptimisePolicy, with `policy` and `summary`."""
        request = OptimisePolicyRequest(method=method, marker=marker, target=Point(*map(float, target_m)), **fields)
        return self._ask('controller/optimise_policy', OptimisePolicy, request)

    def play(self, policy=None, wait_until_rest=True, **fields):
        """Plays a policy: of `optimise`, a dictionary {time_s: {name: value}}, or None for what was found last."""
        if isinstance(policy, dict):
            policy = _policy_of(policy)
        if policy is not None and not (policy.names and policy.steps):
            raise SessionError('policy: it has no commands; None plays what was found last')
        request = ExecutePolicyRequest(policy=policy or Policy(), wait_until_rest=wait_until_rest, **fields)
        answer = self._ask('controller/execute_policy', ExecutePolicy, request)
        self._catch_up(answer.markers.header.stamp)
        return answer

    def reach(self, marker, target_m, method='gauss_newton', closed_loop=False):
        """Optimises and plays; returns how far from the target the simulated marker rests [m]."""
        self.optimise(marker, target_m, method)
        self.play(closed_loop=closed_loop)
        return float(numpy.linalg.norm(self.markers()[marker] - numpy.asarray(target_m, float)))

    def follow(self, path, wait_s=600.0, **fields):
        """Plans commands with which a marker follows a curve, and plays them; the result of FollowPath. `path`: its file."""
        client = actionlib.ActionClient(self._prefix + 'controller/follow_path', FollowPathAction)
        try:
            if not client.wait_for_server(rospy.Duration(60.0)):
                raise SessionError('controller/follow_path does not answer')
            goal = client.send_goal(FollowPathGoal(path=os.path.abspath(path), **fields))
            try:
                _poll(lambda: goal.get_comm_state() == actionlib.CommState.DONE, wait_s, 'the path does not end within %g s' % wait_s)
            except SessionError:
                goal.cancel()
                raise
            result = goal.get_result()
        finally:
            client.stop()
        if not result.success:
            raise SessionError('controller/follow_path: ' + result.message)
        return result

    def record(self, duration_s, source='simulator'):
        """What happens in so many seconds of the session, as NumPy arrays."""
        with self._changed:
            self._recorded = (source, [], [])
        _, recorded, states = self._recorded
        try:
            self._wait(lambda: recorded and recorded[-1][0] - recorded[0][0] >= duration_s, 60.0 + 100.0 * duration_s,
                       'no markers of the %s came' % source)
        finally:
            with self._changed:
                self._recorded = None
        return _arrays(recorded, states)

    def reset(self):
        return self._ask('simulator/reset', Trigger)

    def load(self, scene):
        """Another robot or scene, by its path."""
        return self._ask('simulator/load', LoadScene, os.path.abspath(scene))

    def use_solver(self, solver):
        """'newton', 'xpbd' or 'reduced' moves the simulation from where it is; '': the scene's own."""
        return self._ask('simulator/use_solver', UseSolver, solver)

    def stop(self):
        """Ends what is optimised or played, if anything is."""
        rospy.ServiceProxy(self._prefix + 'controller/cancel', Trigger)()

    def _wait_for_links(self, limit_s):
        """What we or the controller send before the simulator hears it would be lost; others that listen may be connected first."""
        topic, simulator = self._prefix + 'actuators/command', self._prefix + 'simulator'
        _poll(lambda: self._commands.impl.has_connection(simulator), limit_s, 'the simulator does not listen to ' + topic)
        _poll(lambda: any(link[1] == simulator and link[4] == topic for link in _links(self._prefix + 'controller')), limit_s,
              'the controller does not find the simulator')

    def _catch_up(self, stamp):
        """Messages of a session that runs faster than real time wait for us."""
        self._wait(lambda: min(self._state.header.stamp, self._markers['simulator'].header.stamp) >= stamp, 60.0,
                   'the messages of the simulator do not come')

    def _ask(self, name, kind, *request):
        service = self._prefix + name
        try:
            rospy.wait_for_service(service, timeout=60.0)
            answer = rospy.ServiceProxy(service, kind)(*request)
        except (rospy.ROSException, rospy.ServiceException) as error:
            raise SessionError('%s does not answer: %s' % (service, error)) from error
        if not answer.success:
            raise SessionError('%s: %s' % (service, answer.message))
        return answer

    def _wait(self, condition, limit_s, otherwise):
        with self._changed:
            if not self._changed.wait_for(condition, limit_s):
                raise SessionError(otherwise)

    def _on_state(self, state):
        with self._changed:
            self._state = state
            if self._recorded:
                self._recorded[2].append((state.header.stamp.to_sec(), self.commands))
            self._changed.notify_all()

    def _on_ranges(self, ranges):
        with self._changed:
            self._ranges = ranges
            self._changed.notify_all()

    def _on_markers(self, markers, source):
        with self._changed:
            self._markers[source] = markers
            if self._recorded and self._recorded[0] == source:
                self._recorded[1].append((markers.header.stamp.to_sec(), self.markers(source)))
            self._changed.notify_all()


def _nodes():
    try:
        system = rosgraph.Master('/session_client').getSystemState()
    except OSError:
        return set()
    return {node for kind in system for _, nodes in kind for node in nodes}


def _poll(condition, limit_s, otherwise):
    """Asks again and again, for what no message reports."""
    end_s = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end_s:
            raise SessionError(otherwise)
        time.sleep(0.05)


def _links(node):
    try:
        return xmlrpc.client.ServerProxy(rosgraph.Master('/session_client').lookupNode(node)).getBusInfo('/session_client')[2]
    except (OSError, rosgraph.MasterException):
        return []


def _end(process):
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    process.wait()


def _policy_of(steps):
    names = sorted({name for values in steps.values() for name in values})
    for time_s, values in steps.items():
        if set(values) != set(names):
            raise SessionError('policy: each step needs all of %s; the one at %g s has %s' % (names, time_s, sorted(values)))
    return Policy(names=names, steps=[PolicyStep(time_s=float(time_s), values=[float(steps[time_s][name]) for name in names])
                                      for time_s in sorted(steps)])


def _arrays(recorded, states):
    missing = numpy.full(3, numpy.nan)
    markers = sorted({name for _, places in recorded for name in places})
    actuators = sorted({name for _, commands in states for name in commands})
    time_s = numpy.array([time_s for time_s, _ in recorded])
    last = numpy.searchsorted([time_s for time_s, _ in states], time_s + 1e-9) - 1  # the state that each came with, or after
    held = [states[i][1] if i >= 0 else {} for i in last]
    return Recording(
        time_s=time_s,
        markers_m={name: numpy.array([places.get(name, missing) for _, places in recorded]) for name in markers},
        commands={name: numpy.array([commands.get(name, numpy.nan) for commands in held]) for name in actuators})
