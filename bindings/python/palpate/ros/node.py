"""The process that speaks ROS 1 for a session: it passes the session's state to topics, an arm's pose to the
session, and the session's force to the arm.

palpate.ros starts it as a program and exchanges records with it over a socket. It uses rospy but not
palpate, and ROS's units: m, rad, N, N m.
"""

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
PACKAGES = "python3-rospy python3-geometry-msgs python3-sensor-msgs python3-diagnostic-msgs"


class Input:
    """The newest message of a topic, while the connection that brought it stands: nobody holds a button of a
    node that is gone."""

    def __init__(self, ros, name, kind):
        self.message = None
        self.topic = ros.subscriber(name, kind, self.take)

    def take(self, message):
        self.message = message

    def newest(self):
        message = self.message
        if message and any(link.header is message._connection_header for link in self.topic.impl.connections):
            return message
        return None


class Arm:
    """A device of another node, with the names of CRTK."""

    def __init__(self, ros, link, name):
        self.ros, self.link = ros, link
        self.stamp = None
        self.frame = ""
        self.lock, self.released = threading.Lock(), False
        self.force = ros.publisher(f"{name}/servo_cf", ros.WrenchStamped)
        self.gripper = Input(ros, f"{name}/gripper/measured_js", ros.JointState)
        self.joy = Input(ros, f"{name}/button", ros.Joy)
        self.pose_topic = ros.subscriber(f"{name}/measured_cp", ros.PoseStamped, None)

    def start(self):
        """The first record of the link is the answer to the session, so poses are passed on from here."""
        self.pose_topic.impl.add_callback(self.pose, None)

    def opening(self):
        gripper = self.gripper.newest()
        return gripper.position[0] if gripper and gripper.position else math.nan

    def buttons(self):
        """1 is held. CRTK devices also send 2, which is a click that has ended."""
        joy = self.joy.newest()
        return sum(1 << bit for bit, held in enumerate(joy.buttons[:32]) if held == 1) if joy else 0

    def pose(self, message):
        """A stamp that stands still is a pose that was not measured again: it becomes stale."""
        arrived, stamp = time.monotonic(), message.header.stamp
        if stamp and stamp == self.stamp:
            return
        self.stamp, self.frame = stamp, message.header.frame_id
        p, q = message.pose.position, message.pose.orientation
        reading = READING.pack(arrived, p.x, p.y, p.z, q.x, q.y, q.z, q.w, self.opening(), self.buttons(),
                               self.pose_topic.get_num_connections())
        try:
            self.link.send(reading, socket.MSG_DONTWAIT)
        except OSError:  # the session does not read, or has ended
            pass

    def push(self, wrench):
        with self.lock:
            if not self.released:
                self.force.publish(self.ros.stamped_wrench(self.frame, wrench))

    def release(self):
        """Zero, after which no force follows. It takes 100 ms, because other threads send it."""
        with self.lock:
            for _ in range(0 if self.released else 5):
                self.force.publish(self.ros.stamped_wrench(self.frame, ZERO))
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
        self.hand.publish(ros.stamped_pose(frame, numbers[0:7]))
        twist = ros.TwistStamped(header=ros.header(frame))
        ros.fill(twist.twist.linear, numbers[7:10])
        ros.fill(twist.twist.angular, numbers[10:13])
        self.velocity.publish(twist)
        self.proxy.publish(ros.stamped_pose(frame, numbers[13:20]))
        self.force.publish(ros.stamped_wrench(frame, numbers[20:26]))
        values = [ros.KeyValue(key, value) for key, value in rest["values"].items()]
        status = ros.DiagnosticStatus(level=rest["level"], name="palpate", message=rest["message"], values=values)
        self.status.publish(ros.DiagnosticArray(header=ros.header(frame), status=[status]))


class Ros:
    """rospy and the messages. Everything is sent by threads of rospy, so that a subscriber that hangs holds
    up nobody else; a message that could not be sent gives way to the next."""

    def __init__(self, arguments):
        import rosgraph
        import rospy
        from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
        from geometry_msgs.msg import PoseStamped, TwistStamped, WrenchStamped
        from sensor_msgs.msg import JointState, Joy
        from std_msgs.msg import Header
        self.rospy, self.Header, self.Joy, self.JointState = rospy, Header, Joy, JointState
        self.PoseStamped, self.TwistStamped, self.WrenchStamped = PoseStamped, TwistStamped, WrenchStamped
        self.DiagnosticArray, self.DiagnosticStatus, self.KeyValue = DiagnosticArray, DiagnosticStatus, KeyValue
        if not rosgraph.is_master_online():
            raise ConnectionError(f"no ROS master at {rosgraph.get_master_uri()}: start roscore, or set ROS_MASTER_URI")
        rospy.init_node("palpate", [sys.argv[0], *arguments], disable_signals=True)

    def publisher(self, name, kind):
        return self.rospy.Publisher(name, kind, queue_size=1, tcp_nodelay=True)

    def subscriber(self, name, kind, callback):
        return self.rospy.Subscriber(name, kind, callback, queue_size=1, tcp_nodelay=True)

    def header(self, frame):
        return self.Header(stamp=self.rospy.Time.now(), frame_id=frame)

    @staticmethod
    def fill(vector, numbers):
        vector.x, vector.y, vector.z = numbers

    def stamped_pose(self, frame, numbers):
        message = self.PoseStamped(header=self.header(frame))
        self.fill(message.pose.position, numbers[:3])
        turn = message.pose.orientation
        turn.x, turn.y, turn.z, turn.w = numbers[3:]
        return message

    def stamped_wrench(self, frame, numbers):
        message = self.WrenchStamped(header=self.header(frame))
        self.fill(message.wrench.force, numbers[:3])
        self.fill(message.wrench.torque, numbers[3:])
        return message


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


def main(number, name, *arguments):
    link = socket.socket(fileno=int(number))
    signal.signal(signal.SIGTERM, lambda *_: sys.exit())  # past the zero below
    try:
        ros = Ros(arguments)
        topics, arm = Topics(ros), Arm(ros, link, name) if name else None
    except ImportError as error:
        link.send(IS_PROBLEM + f"{error}: apt install {PACKAGES}".encode())
        return
    except Exception as error:
        link.send(IS_PROBLEM + str(error).encode())
        return

    def end():
        """Also when ROS ends the node, after which rospy sends nothing."""
        if arm:
            arm.release()
        link.shutdown(socket.SHUT_RDWR)

    ros.rospy.on_shutdown(end)
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
        ros.rospy.signal_shutdown("the session has ended")


if __name__ == "__main__":
    main(*sys.argv[1:])
