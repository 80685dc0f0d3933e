#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A session of muscle_bar.yaml: muscles pull as their law has it, the controller plans with them, wrong keys are errors."""
import math
import os
import tempfile
import unittest

import rospkg
import rospy
import rostest
from geometry_msgs.msg import Point
from soft_robot_lab.msg import ActuatorCommand, ActuatorState, MarkerObservations
from soft_robot_lab.srv import ExecutePolicy, LoadScene, OptimisePolicy

SCENE = os.path.join(rospkg.RosPack().get_path("example_plugin"), "muscle_bar.yaml")
AREA_M2 = math.pi / 4 * 0.004**2  # of muscle_bar.yaml
ANGLE = math.radians(25)
TARGET = Point(-0.02, 0, -0.095)


def tension_n(pressure_pa, stretch):
    force_n = AREA_M2 * pressure_pa * (3 * stretch**2 / math.tan(ANGLE)**2 - 1 / math.sin(ANGLE)**2)
    return max(0.0, force_n)


def call(name, kind, **request):
    rospy.wait_for_service(name, 60)
    return rospy.ServiceProxy(name, kind)(**request)


def tip():
    markers = rospy.wait_for_message("simulator/markers", MarkerObservations, 60)
    return markers.positions[markers.names.index("tip")]


def actuators_when(condition):
    for _ in range(600):
        state = rospy.wait_for_message("simulator/actuators", ActuatorState, 60)
        if condition(state):
            return state
    raise AssertionError("never came: %s" % state)


class MuscleSession(unittest.TestCase):
    def test_1_a_muscle_pulls_as_its_law_has_it(self):
        actuators_when(lambda state: state.names == ["left", "right"])
        at_rest = tip()
        publisher = rospy.Publisher("actuators/command", ActuatorCommand, queue_size=1, latch=True)
        publisher.publish(ActuatorCommand(names=["right"], values=[40000.0]))
        state = actuators_when(lambda state: state.actuated_commands[1] == 40000.0)
        self.assertEqual(state.commands, (0.0, 40000.0))
        left, right = state.cables
        self.assertEqual(left.tension_n, 0.0)
        expected_n = tension_n(40000.0, right.length_m / right.rest_length_m)
        self.assertGreater(expected_n, 1.0)
        self.assertAlmostEqual(right.tension_n, expected_n, delta=0.01 * expected_n)
        self.assertGreater(tip().x, at_rest.x + 0.005)

    def test_2_the_controller_reaches_a_target_with_muscles(self):
        answer = call("controller/optimise_policy", OptimisePolicy, method="gauss_newton", marker="tip", target=TARGET)
        self.assertTrue(answer.success, answer.message)
        self.assertLess(answer.summary.final_distance_m, 0.1 * answer.summary.initial_distance_m)
        self.assertGreater(answer.policy.steps[-1].values[answer.policy.names.index("left")], 1000.0)
        played = call("controller/execute_policy", ExecutePolicy, policy=answer.policy, wait_until_rest=True)
        self.assertTrue(played.success, played.message)
        at = tip()
        reached_m = math.dist((at.x, at.y, at.z), (answer.summary.marker.x, answer.summary.marker.y, answer.summary.marker.z))
        self.assertLess(reached_m, 0.001)

    def test_3_wrong_settings_are_errors_with_file_and_line(self):
        with open(SCENE, encoding="utf-8") as file:
            text = file.read()
        for right, wrong, message in (
                ("braid_angle_deg: 25", "braid_angle_deg: 60", "actuators[0].braid_angle_deg: 60"),
                ("diameter_m: 0.004", "diametre_m: 0.004", "diameter_m"),
                ("example_plugin/McKibbenMuscle", "example_plugin/Muscle", "example_plugin/McKibbenMuscle")):
            with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
                file.write(text.replace(right, wrong, 1))
                file.flush()
                answer = call("simulator/load", LoadScene, path=file.name)
                self.assertFalse(answer.success)
                self.assertIn(message, answer.message)


if __name__ == "__main__":
    rospy.init_node("muscle_session_test")
    rostest.rosrun("example_plugin", "muscle_session", MuscleSession)
