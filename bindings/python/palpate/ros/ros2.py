"""ROS 2 for node.py, without ROS 2 itself: its messages, names and settings over DDS (dds.py)."""

import os
import time
from ctypes import c_char_p, c_double, c_float, c_int32, c_uint8, c_uint32

import dds
from dds import Message, sequence_of

PACKAGES = dds.PACKAGE


class Time(Message):
    _fields_ = [("sec", c_int32), ("nanosec", c_uint32)]


class Header(Message):
    _fields_ = [("stamp", Time), ("frame_id", c_char_p)]


class Vector3(Message):
    _fields_ = [("x", c_double), ("y", c_double), ("z", c_double)]


class Quaternion(Message):
    _fields_ = [*Vector3._fields_, ("w", c_double)]


class Pose(Message):
    _fields_ = [("position", Vector3), ("orientation", Quaternion)]


class Twist(Message):
    _fields_ = [("linear", Vector3), ("angular", Vector3)]


class Wrench(Message):
    _fields_ = [("force", Vector3), ("torque", Vector3)]


class KeyValue(Message):
    _fields_ = [("key", c_char_p), ("value", c_char_p)]


class DiagnosticStatus(Message):
    _fields_ = [("level", c_uint8), ("name", c_char_p), ("message", c_char_p), ("hardware_id", c_char_p),
                ("values", sequence_of(KeyValue))]


class PoseStamped(Message):
    _fields_ = [("header", Header), ("pose", Pose)]


class TwistStamped(Message):
    _fields_ = [("header", Header), ("twist", Twist)]


class WrenchStamped(Message):
    _fields_ = [("header", Header), ("wrench", Wrench)]


class DiagnosticArray(Message):
    _fields_ = [("header", Header), ("status", sequence_of(DiagnosticStatus))]


class JointState(Message):
    _fields_ = [("header", Header), ("name", sequence_of(c_char_p)), ("position", sequence_of(c_double)),
                ("velocity", sequence_of(c_double)), ("effort", sequence_of(c_double))]


class Joy(Message):
    _fields_ = [("header", Header), ("axes", sequence_of(c_float)), ("buttons", sequence_of(c_int32))]


FOLDERS = {PoseStamped: "geometry", TwistStamped: "geometry", WrenchStamped: "geometry",
           DiagnosticArray: "diagnostic", JointState: "sensor", Joy: "sensor"}
# Settings of Cyclone DDS. Without hashes of keys, Fast DDS does not notice for 10 s that a node has ended.
HASHES = '<Domain Id="any"><Internal><GenerateKeyhash>true</GenerateKeyhash></Internal></Domain>'
# As ROS_LOCALHOST_ONLY asks for it. Without multicast, participants are found by their number.
LOOPBACK = ('<Domain Id="any"><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>'
            '<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>'
            '<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex></Discovery></Domain>')


def settings(environment):
    """For Cyclone DDS. Those of CYCLONEDDS_URI come last, so they count."""
    loopback = LOOPBACK if environment.get("ROS_LOCALHOST_ONLY") == "1" else ""
    return ",".join(filter(None, (HASHES, loopback, environment.get("CYCLONEDDS_URI"))))


class Names:
    """Of topics, with the remappings of the command line: __node:=NAME, __ns:=/NAMESPACE, FROM:=TO."""

    def __init__(self, arguments):
        given = dict(argument.split(":=", 1) for argument in arguments)
        self.space = "/" + given.pop("__ns", "").strip("/")
        self.node = given.pop("__node", given.pop("__name", "palpate"))
        self.changed = {self.whole(name): self.whole(to) for name, to in given.items()}

    def whole(self, name):
        if name.startswith("~"):
            name = f"{self.node}/{name.lstrip('~/')}"
        return name if name.startswith("/") else f"{self.space.rstrip('/')}/{name}"

    def topic(self, name):
        whole = self.whole(name)
        return "rt" + self.changed.get(whole, whole)


class Input:
    """The newest message of a topic, while its writer is there: nobody holds a button of a node that is gone."""

    def __init__(self, participant, topic, kind, type_name, reliability):
        self.last, self.callback = (None, None), None
        self.reader = participant.reader(topic, kind, type_name, self.take, reliability)

    def take(self, message, writer):
        self.last = message, writer
        if self.callback:
            self.callback(message)

    def listen(self, callback):
        self.callback = callback

    def newest(self):
        message, writer = self.last
        return message if writer in self.reader.writers() else None

    def writers(self):
        return len(self.reader.writers())


class Ros:
    """A participant of DDS that a node of ROS 2 takes for one of its kind."""

    Header, KeyValue, DiagnosticStatus = Header, KeyValue, DiagnosticStatus

    def __init__(self, arguments):
        vars(self).update({kind.__name__: kind for kind in FOLDERS})
        self.names = Names(arguments)
        os.environ["CYCLONEDDS_URI"] = settings(os.environ)
        self.participant = dds.Participant(int(os.environ.get("ROS_DOMAIN_ID") or 0))

    @staticmethod
    def type_name(kind):
        return f"{FOLDERS[kind]}_msgs::msg::dds_::{kind.__name__}_"

    def publisher(self, name, kind):
        return self.participant.writer(self.names.topic(name), kind, self.type_name(kind))

    def subscriber(self, name, kind):
        """A button is sent once, so it must not be lost. A pose that is lost is followed by another one."""
        reliability = dds.RELIABLE if kind is Joy else dds.BEST_EFFORT
        return Input(self.participant, self.names.topic(name), kind, self.type_name(kind), reliability)

    def header(self, frame):
        sec, nanosec = divmod(time.time_ns(), 10**9)
        return Header(stamp=Time(sec=sec, nanosec=nanosec), frame_id=frame)

    def nanoseconds(self, stamp):
        return stamp.sec * 10**9 + stamp.nanosec

    def on_shutdown(self, end):
        """Nobody ends a node of ROS 2 but its own process."""

    def shutdown(self):
        self.participant.close()
