"""Nodes of ROS for ros_test.py, rospy with a real master and Fast DDS, and a device on top of either."""

import contextlib
import os
import socket
import subprocess
import sys
import threading
import time

import fast_dds
import pytest
from geometry_msgs.msg import PoseStamped, WrenchStamped
from live_test import surface_height, until
from sensor_msgs.msg import JointState, Joy

import palpate
from palpate.ros import Node


def ros_1(log):
    """rospy, with a master of its own."""
    reserved = socket.socket()  # which the master may use as well, as it does not listen
    reserved.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    reserved.bind(("127.0.0.1", 0))
    port = reserved.getsockname()[1]
    os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1",
                      ROS_LOG_DIR=str(log))
    with pytest.raises(palpate.DeviceError, match="no ROS master at .*: start roscore"):
        Node()
    master = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL)
    import rosgraph
    import rospy
    until(rosgraph.is_master_online)
    rospy.init_node("peer", disable_signals=True)
    rospy.version = 1
    yield rospy
    rospy.signal_shutdown("done")
    master.terminate()
    master.wait()
    reserved.close()


def ros_2():
    """Fast DDS on the loopback, in a domain that nothing else uses."""
    if not fast_dds.PROGRAM.exists():
        pytest.skip("Fast DDS was not installed at build time (scripts/install_packages.sh test)")
    os.environ.update(ROS_LOCALHOST_ONLY="1", ROS_DOMAIN_ID=str(1 + os.getpid() % 90))
    peer = fast_dds.FastDds(os.environ["ROS_DOMAIN_ID"])
    try:
        yield peer
    finally:
        peer.close()


class Peer:
    """A device of ROS whose pose is sent again and again. Palpate's z, towards the person, is ROS's -x."""

    def __init__(self, ros, arm):
        self.ros, self.height, self.opening, self.buttons = ros, surface_height() + 1, None, None
        self.stamped = self.sends = True
        self.forces, self.stamp = [], None
        self.topic = ros.Publisher(f"{arm}/measured_cp", PoseStamped, queue_size=1, tcp_nodelay=True)
        self.gripper = ros.Publisher(f"{arm}/gripper/measured_js", JointState, queue_size=1)
        self.joy = ros.Publisher(f"{arm}/button", Joy, queue_size=1)
        self.wrench = ros.Subscriber(f"{arm}/servo_cf", WrenchStamped, self.forces.append, tcp_nodelay=True)
        self.ends = False
        self.lock = threading.Lock()  # of what is sent: a topic that is closed meanwhile raises
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        while not self.ends:
            time.sleep(0.002)
            with self.lock:
                if self.sends:
                    self.send()

    def send(self):
        message = PoseStamped()
        self.stamp = self.ros.Time.now() if self.stamped else self.stamp
        message.header.stamp, message.header.frame_id = self.stamp, "base"
        message.pose.position.x, message.pose.orientation.w = -self.height / 1000, 1
        self.topic.publish(message)
        if self.opening is not None:
            self.gripper.publish(JointState(position=[self.opening]))
        if self.buttons is not None:
            self.joy.publish(Joy(buttons=self.buttons))

    def lose_buttons_and_gripper(self):
        """Their node is gone."""
        with self.lock:
            self.buttons = self.opening = None
            self.joy.unregister()
            self.gripper.unregister()

    def pushes(self):
        """Outwards, which is to the person."""
        return bool(self.forces) and self.forces[-1].wrench.force.x < -0.2

    def rests(self):
        force = self.forces[-1].wrench.force
        return force.x == force.y == force.z == 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ends = True
        self.thread.join()
        for topic in (self.topic, self.gripper, self.joy, self.wrench):
            topic.unregister()


SECOND = """
import rospy
from geometry_msgs.msg import PoseStamped
rospy.init_node("second")
pose = rospy.Publisher("/left/measured_cp", PoseStamped, queue_size=1)
rospy.spin()
"""


@contextlib.contextmanager
def second_peer(ros, topic):
    """Another node that can send poses."""
    if ros.version == 1:
        second = subprocess.Popen([sys.executable, "-c", SECOND.replace("/left/measured_cp", topic)])
        try:
            yield
        finally:
            second.kill()
            second.wait()
    else:
        second = fast_dds.FastDds(os.environ["ROS_DOMAIN_ID"])
        second.Publisher(topic, PoseStamped)
        try:
            yield
        finally:
            second.close()
