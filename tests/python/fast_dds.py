"""A node of ROS 2 for ros_test.py, used as rospy is: its program (fast_dds.cpp) speaks DDS with eProsima's
implementation, which shares no code with ours."""

import os
import pathlib
import shlex
import subprocess
import threading
import time

import genpy
import roslib.message

PROGRAM = pathlib.Path(os.environ.get("PALPATE_BUILD", "."), "tests", "python", "fast_dds_node")


def words(value):
    """A message as a line; messages of ROS 2 are those of ROS 1 without seq."""
    if isinstance(value, genpy.Message):
        return " ".join(words(getattr(value, name)) for name in value.__slots__ if name != "seq")
    if isinstance(value, genpy.Time):
        return f"{value.secs} {value.nsecs}"
    if isinstance(value, (list, tuple)):
        return " ".join(map(words, (len(value), *value)))
    return f'"{value}"' if isinstance(value, str) else repr(value)


def message(kind, left):
    """Of a kind such as float64[] or geometry_msgs/Pose, from the iterator of its words."""
    if kind.endswith("[]"):
        return [message(kind[:-2], left) for _ in range(int(next(left)))]
    if kind == "time":
        return genpy.Time(int(next(left)), int(next(left)))
    if "/" in kind:
        made = roslib.message.get_message_class(kind)()
        for name, part in zip(made.__slots__, made._slot_types):
            if name != "seq":
                setattr(made, name, message(part, left))
        return made
    return next(left) if kind == "string" else (float if "float" in kind else int)(next(left))


class Endpoint:
    def __init__(self, node, what, topic, kind, callback=None):
        self.node, self.topic, self.kind, self.callback = node, topic, kind, callback
        self.connections = 0
        node.endpoints[topic] = self
        node.say(f"{what} {topic} {kind.__name__}")

    def publish(self, told):
        self.node.say(f"message {self.topic} {words(told)}")

    def get_num_connections(self):
        return self.connections

    def unregister(self):
        self.node.say(f"end {self.topic}")


class FastDds:
    version = 2

    class Time:
        @staticmethod
        def now():
            return genpy.Time.from_sec(time.time())

    def __init__(self, domain):
        self.process = subprocess.Popen([PROGRAM, str(domain)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.endpoints, self.one = {}, threading.Lock()
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()

    def say(self, line):
        with self.one:
            self.process.stdin.write(line + "\n")
            self.process.stdin.flush()

    def listen(self):
        for line in self.process.stdout:
            what, topic, *rest = shlex.split(line)
            endpoint = self.endpoints[topic]
            if what == "matched":
                endpoint.connections = int(rest[0])
            else:
                endpoint.callback(message(endpoint.kind._type, iter(rest)))

    def Publisher(self, topic, kind, **_):
        return Endpoint(self, "publish", topic, kind)

    def Subscriber(self, topic, kind, callback, **_):
        return Endpoint(self, "subscribe", topic, kind, callback)

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.thread.join()
