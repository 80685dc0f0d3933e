# SPDX-License-Identifier: BSD-3-Clause
"""python3 -m soft_robot_lab.life.lab REQUEST.json: one emulated session, in a process and with a ROS master of its own. It calibrates the
cameras, drives a table, plays policies, and writes what it saw into the request's `answer`."""
import json
import os
import socket
import struct
import subprocess
import sys
import zlib

import numpy
import rospy
from sensor_msgs.msg import Image
from std_srvs.srv import SetBool

from soft_robot_lab.msg import MarkerObservations
from soft_robot_lab.session import Session, SessionError
from soft_robot_lab.srv import Calibrate

FRAMES_S = 5.0  # so that the cameras have filmed what was changed
FIRST_SIGHT_S = 120.0
SEEN_S = 2.0


def own_master():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        port = probe.getsockname()[1]
    os.environ.update(ROS_MASTER_URI='http://127.0.0.1:%d' % port, ROS_IP='127.0.0.1')
    for name in ('ROS_HOSTNAME', 'ROS_NAMESPACE'):
        os.environ.pop(name, None)


def ask(name, kind, *request):
    rospy.wait_for_service(name, timeout=60.0)
    answer = rospy.ServiceProxy(name, kind)(*request)
    if not answer.success:
        raise SessionError('%s: %s' % (name, answer.message))
    return answer


def calibrate():
    """Where each camera stands, by balls: how far these are off, in metres."""
    rospy.sleep(FRAMES_S)
    ask('/tracker/calibrate', Calibrate, False)
    ask('/rendered_cameras/show_balls', SetBool, True)
    rospy.sleep(FRAMES_S)
    try:
        found = ask('/tracker/calibrate', Calibrate, True)
    finally:
        ask('/rendered_cameras/show_balls', SetBool, False)
    rospy.sleep(FRAMES_S)
    return dict(zip(found.cameras, found.residuals_m))


def rest(session):
    """By way of slack cables, as a drive that pays out stops short of its zero."""
    rests = {name: limits[0] for name, limits in session.actuators.items()}
    slack = {name: min(1.05, limits[2]) if name in session.tensions_n and limits[3] == '1' else limits[0]
             for name, limits in session.actuators.items()}
    for commands in ([slack] if slack != rests else []) + [rests]:
        session.play({1.0: commands})


def play(session, policy):
    """Where the marker was tracked once the robot rested."""
    rest(session)
    steps = {step['time_s']: dict(zip(policy['names'], step['values'])) for step in policy['steps']}
    session.play(steps)
    seen = session.record(SEEN_S, 'tracker').markers_m.get(policy['marker'])
    if seen is None or numpy.isnan(seen).all():
        raise SessionError('the tracker does not see %s there' % policy['marker'])
    position_m = numpy.nanmedian(seen, axis=0)
    return {'at_m': list(position_m), 'off_m': float(numpy.linalg.norm(position_m - policy['target_m']))}


def write_png(image, path):
    """Of an image of rgb8 or bgr8."""
    rows = numpy.frombuffer(image.data, numpy.uint8).reshape(image.height, image.step)[:, :3 * image.width].reshape(image.height, image.width, 3)
    rows = rows[:, :, ::-1] if image.encoding == 'bgr8' else rows
    raw = b''.join(b'\0' + row.tobytes() for row in rows)

    def chunk(kind, content):
        return struct.pack('>I', len(content)) + kind + content + struct.pack('>I', zlib.crc32(kind + content))

    with open(path, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', image.width, image.height, 8, 2, 0, 0, 0)) +
                   chunk(b'IDAT', zlib.compress(raw)) + chunk(b'IEND', b''))


def run(request):
    answer = {'calibration': {}, 'table': '', 'policies': {}}
    with Session.start(wait_s=180.0, **request['arguments']) as session:
        rospy.wait_for_message('/tracker/markers', MarkerObservations, timeout=FIRST_SIGHT_S)
        if request.get('calibrate'):
            answer['calibration'] = calibrate()
        if request.get('table'):
            done = subprocess.run(['rosrun', 'soft_robot_lab', 'run_table_node', request['table'], str(request['hold_s'])], stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, check=False)
            answer['table'] = done.stdout
            if done.returncode:
                raise SessionError('run_table_node: ' + done.stderr.strip())
        for policy in request.get('policies', []):
            answer['policies'][policy['name']] = play(session, policy)
        write_png(rospy.wait_for_message('/overlay/image', Image, timeout=30.0), request['picture'])
        if not request.get('policies'):
            rest(session)
    return answer


def main():
    with open(sys.argv[1], encoding='utf-8') as file:
        request = json.load(file)
    own_master()
    try:
        answer = run(request)
    except (SessionError, rospy.ROSException) as error:
        sys.exit(str(error))
    with open(request['answer'], 'w', encoding='utf-8') as file:
        json.dump(answer, file, indent=2)
    return 0


if __name__ == '__main__':
    sys.exit(main())
