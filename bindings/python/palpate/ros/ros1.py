"""ROS 1 for node.py: rospy."""

import sys

PACKAGES = "python3-rospy python3-geometry-msgs python3-sensor-msgs python3-diagnostic-msgs"


class Input:
    """The newest message of a topic, while the connection that brought it stands: nobody holds a button of a
    node that is gone."""

    def __init__(self, rospy, name, kind):
        self.message = self.callback = None
        self.topic = rospy.Subscriber(name, kind, self.take, queue_size=1, tcp_nodelay=True)

    def take(self, message):
        self.message = message
        if self.callback:
            self.callback(message)

    def listen(self, callback):
        self.callback = callback

    def newest(self):
        message = self.message
        if message and any(link.header is message._connection_header for link in self.topic.impl.connections):
            return message
        return None

    def writers(self):
        return self.topic.get_num_connections()


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

    def subscriber(self, name, kind):
        return Input(self.rospy, name, kind)

    def header(self, frame):
        return self.Header(stamp=self.rospy.Time.now(), frame_id=frame)

    def nanoseconds(self, stamp):
        return stamp.to_nsec()

    def on_shutdown(self, end):
        """ROS ends a node: rosnode kill, or a second node of the same name."""
        self.rospy.on_shutdown(end)

    def shutdown(self):
        self.rospy.signal_shutdown("the session has ended")
