"""The process that speaks ROS for a session: it passes the session's state to topics, an arm's pose to the
session, and the session's force to the arm.

palpate.ros starts it as a program and exchanges records with it over a socket. It uses ros1.py or ros2.py, which
are alike, but not palpate, and ROS's units: m, rad, N, N m.
"""

import importlib
import json
import math
import select
import signal
import socket
import struct
import sys
import threading
import time

# To the session: when the pose arrived [s, CLOCK_MONOTONIC], position, orientation x, y, z, w, opening of
# the gripper [rad] (NaN: none), a bit for each button, how many nodes send poses.
READING = struct.Struct("=d3d4ddII")
# From the session, after one byte that tells which: when it was sent [s, CLOCK_MONOTONIC], force and torque;
# or the state (position, orientation, linear and angular velocity of the hand; position and orientation of
# the proxy; force and torque; then frame, level, message and values as JSON).
WRENCH, IS_WRENCH = struct.Struct("=7d"), b"w"
STATE, IS_STATE = struct.Struct("=3d4d3d3d3d4d6d"), b"s"
# To the session, once, at the beginning: ready, or why not.
IS_READY, IS_PROBLEM = b"r", b"p"
SILENCE = 0.02  # [s] after which a force that was not renewed ends
ZERO = (0,) * 6


def fill(vector, numbers):
    vector.x, vector.y, vector.z = numbers


def stamped_pose(ros, frame, numbers):
    message = ros.PoseStamped(header=ros.header(frame))
    fill(message.pose.position, numbers[:3])
    turn = message.pose.orientation
    turn.x, turn.y, turn.z, turn.w = numbers[3:]
    return message


def stamped_wrench(ros, frame, numbers):
    message = ros.WrenchStamped(header=ros.header(frame))
    fill(message.wrench.force, numbers[:3])
    fill(message.wrench.torque, numbers[3:])
    return message


class Arm:
    """A device of another node, with the names of CRTK."""

    def __init__(self, ros, link, name):
        self.ros, self.link = ros, link
        self.stamp = None
        self.frame = ""
        self.lock, self.released = threading.Lock(), False
        self.force = ros.publisher(f"{name}/servo_cf", ros.WrenchStamped)
        self.gripper = ros.subscriber(f"{name}/gripper/measured_js", ros.JointState)
        self.joy = ros.subscriber(f"{name}/button", ros.Joy)
        self.poses = ros.subscriber(f"{name}/measured_cp", ros.PoseStamped)

    def start(self):
        """The first record of the link is the answer to the session, so poses are passed on from here."""
        self.poses.listen(self.pose)

    def opening(self):
        gripper = self.gripper.newest()
        return gripper.position[0] if gripper and gripper.position else math.nan

    def buttons(self):
        """1 is held. CRTK devices also send 2, which is a click that has ended."""
        joy = self.joy.newest()
        return sum(1 << bit for bit, held in enumerate(joy.buttons[:32]) if held == 1) if joy else 0

    def pose(self, message):
        """A stamp that stands still is a pose that was not measured again: it becomes stale."""
        arrived, stamp = time.monotonic(), self.ros.nanoseconds(message.header.stamp)
        if stamp and stamp == self.stamp:
            return
        self.stamp, self.frame = stamp, message.header.frame_id
        p, q = message.pose.position, message.pose.orientation
        reading = READING.pack(arrived, p.x, p.y, p.z, q.x, q.y, q.z, q.w, self.opening(), self.buttons(),
                               self.poses.writers())
        try:
            self.link.send(reading, socket.MSG_DONTWAIT)
        except OSError:  # the session does not read, or has ended
            pass

    def push(self, wrench):
        with self.lock:
            if not self.released:
                self.force.publish(stamped_wrench(self.ros, self.frame, wrench))

    def release(self):
        """Zero, after which no force follows. It takes 100 ms, because other threads send it."""
        with self.lock:
            for _ in range(0 if self.released else 5):
                self.force.publish(stamped_wrench(self.ros, self.frame, ZERO))
                time.sleep(SILENCE)
            self.released = True


class Topics:
    """What a session tells, below the name of the node."""

    def __init__(self, ros):
        self.ros = ros
        self.hand = ros.publisher("~hand/measured_cp", ros.PoseStamped)
        self.velocity = ros.publisher("~hand/measured_cv", ros.TwistStamped)
        self.force = ros.publisher("~hand/setpoint_cf", ros.WrenchStamped)
        self.proxy = ros.publisher("~proxy/measured_cp", ros.PoseStamped)
        self.status = ros.publisher("~status", ros.DiagnosticArray)

    def tell(self, record):
        numbers, rest = STATE.unpack_from(record), json.loads(record[STATE.size:])
        ros, frame = self.ros, rest["frame"]
        self.hand.publish(stamped_pose(ros, frame, numbers[0:7]))
        twist = ros.TwistStamped(header=ros.header(frame))
        fill(twist.twist.linear, numbers[7:10])
        fill(twist.twist.angular, numbers[10:13])
        self.velocity.publish(twist)
        self.proxy.publish(stamped_pose(ros, frame, numbers[13:20]))
        self.force.publish(stamped_wrench(ros, frame, numbers[20:26]))
        values = [ros.KeyValue(key=key, value=value) for key, value in rest["values"].items()]
        status = ros.DiagnosticStatus(level=rest["level"], name="palpate", message=rest["message"], values=values)
        self.status.publish(ros.DiagnosticArray(header=ros.header(frame), status=[status]))


def drained(link):
    """The newest record of each kind among those that wait. None: the link is closed."""
    newest = {}
    try:
        for _ in range(1000):  # more than the link holds: a fast sender must not hold this up
            record = link.recv(1 << 16, socket.MSG_DONTWAIT)
            if not record:
                return None
            newest[record[:1]] = record[1:]
    except BlockingIOError:
        pass
    return newest


def serve(link, topics, arm, clock=time.monotonic, wait=select.select):
    """Until the link is closed. An arm whose force the session does not renew gets zero."""
    due = 0.0  # when the arm gets its next zero
    while True:
        wait([link], [], [], max(0, due - clock()) if arm else None)
        newest = drained(link)
        if newest is None:
            return
        if IS_WRENCH in newest:
            sent, *wrench = WRENCH.unpack(newest[IS_WRENCH])
            due = sent + SILENCE
        if arm and clock() >= due:
            arm.push(ZERO)
            due = clock() + SILENCE
        elif arm and IS_WRENCH in newest:
            arm.push(wrench)
        if IS_STATE in newest:
            topics.tell(newest[IS_STATE])


def main(number, version, name, *arguments):
    link = socket.socket(fileno=int(number))
    signal.signal(signal.SIGTERM, lambda *_: sys.exit())  # past the zero below
    transport = importlib.import_module(f"ros{version}")
    try:
        ros = transport.Ros(arguments)
        topics, arm = Topics(ros), Arm(ros, link, name) if name else None
    except ImportError as error:
        link.send(IS_PROBLEM + f"{error}: apt install {transport.PACKAGES}".encode())
        return
    except Exception as error:
        link.send(IS_PROBLEM + str(error).encode())
        return

    def end():
        """Also when ROS ends the node, after which nothing is sent."""
        if arm:
            arm.release()
        link.shutdown(socket.SHUT_RDWR)

    ros.on_shutdown(end)
    try:
        link.send(IS_READY)
        if arm:
            arm.start()
        serve(link, topics, arm)
    except ConnectionError:  # the session was killed
        pass
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        end()
        ros.shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
