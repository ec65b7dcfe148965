"""ROS 1 and ROS 2: a session's hand, proxy, force and status as topics, and a device that ROS moves (docs/ros.md).

The node runs in a process of its own. Neither the servo nor the device's thread ever waits for it.
"""

import collections
import json
import math
import socket
import subprocess
import sys
import time
from typing import Any, Optional, Sequence, Union

import numpy

from palpate import FORCE_FLAGS, DeviceError, DeviceInfo, DeviceReading, Run, Servo, Snapshot

from . import node

MM = 1000  # of a metre; N mm of a newton metre
DELAY = 0.002  # [s] that the way through ROS adds (docs/ros.md)
EXCHANGE = 0.0021  # [s] that a Run adds, which asks the device 1000 times per second (docs/servo.md)
POSE_RATE = 150  # [Hz], the smallest that counts as a pose that is measured again and again
POSES = 32  # whose mean rate is taken
LEVELS = {"ready": 0, "finished": 0, "starting": 1, "uncalibrated": 1, "lost": 2, "fault": 2, "stale": 3}


def axes_from(text: str) -> Any:
    """The matrix that takes ROS's axes to Palpate's (x to the right, y up, z towards the person). `text`: what
    each of these is in ROS, such as '-y,z,-x'. Raises ValueError for what is no rotation."""
    rows = []
    for name in text.replace(" ", "").split(","):
        row = [0.0, 0.0, 0.0]
        if name.lstrip("+-") not in ("x", "y", "z") or len(name) > 2:
            raise ValueError(f"'{text}' are no axes: three of x, y, z with signs are needed, such as -y,z,-x")
        row["xyz".index(name[-1])] = -1.0 if name[0] == "-" else 1.0
        rows.append(row)
    axes = numpy.array(rows)
    if axes.shape != (3, 3) or round(numpy.linalg.det(axes)) != 1:
        raise ValueError(f"'{text}' are no axes of a rotation: each one is needed once, and not mirrored")
    return axes


def velocity(before: Any, after: Any) -> tuple[Any, Any]:
    """Of the hand between two ticks, linear [mm/s] and angular [rad/s], physical axes; zero where there was no
    time."""
    passed = after.time - before.time
    if not passed > 0:
        return numpy.zeros(3), numpy.zeros(3)
    x, y, z, w = after.hand_orientation_xyzw
    a, b, c, d = before.hand_orientation_xyzw
    axis = d * numpy.array([x, y, z]) - w * numpy.array([a, b, c]) - numpy.cross([x, y, z], [a, b, c])
    cosine = w * d + x * a + y * b + z * c
    sine = numpy.linalg.norm(axis)
    angle = 2 * math.atan2(sine, abs(cosine)) * (1 if cosine >= 0 else -1)
    return (after.hip - before.hip) / passed, axis * (angle / sine / passed if sine else 0.0)


def state_record(snapshot: Snapshot, before: Any, problem: str, frame: str) -> bytes:
    """A snapshot as the node takes it: m, N, N m, in the axes of the volume."""
    tick, device = snapshot.tick, snapshot.device
    linear, angular = velocity(before, tick)
    turn = snapshot.transform.rotation
    numbers = (tick.hip / MM, tick.hand_orientation_xyzw, linear / MM, angular,
               tick.scp / MM, tick.proxy_orientation_xyzw, turn @ tick.force, turn @ tick.torque / MM)
    flags = [name for name, bit in FORCE_FLAGS.items() if tick.force_flags & bit]
    values = {"device": device.status, "mode": tick.mode, "force [N]": f"{numpy.linalg.norm(tick.force):.3f}",
              "isovalue": f"{tick.isovalue:g}", "forces": "on" if snapshot.forces_on else "off",
              "force flags": ", ".join(flags), "buttons": str(device.buttons), "ticks": str(snapshot.number + 1),
              "missed": str(snapshot.missed)}
    if device.opening is not None:
        values["opening [rad]"] = f"{device.opening:.3f}"
    message = problem or (tick.mode if device.status == "ready" else device.status)
    rest = {"frame": frame, "level": LEVELS[device.status], "message": message, "values": values}
    return node.IS_STATE + node.STATE.pack(*numpy.concatenate(numbers)) + json.dumps(rest).encode()


class Node:
    """A ROS node in a process of its own, until close(). Use it as a context manager, around the run."""

    def __init__(self, arguments: Sequence[str] = (), *, arm: str = "", frame: str = "volume",
                 ros: int = 1) -> None:
        """arguments: ROS's own, such as __name:=left or a remapping. arm: the namespace of a device that
        device() connects to; empty: none. frame: frame_id of the volume's space (LPS). ros: 1 or 2. Raises
        ValueError for another number, and DeviceError without rospy or a ROS master (ROS 1), or Cyclone DDS (ROS 2)."""
        if ros not in (1, 2):
            raise ValueError(f"ros: {ros} must be 1 or 2")
        self._link, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._arm, self._frame, self._before = arm, frame, None
        with theirs:
            # A session of its own, so that Ctrl-C ends Palpate first.
            self._process = subprocess.Popen(
                [sys.executable, node.__file__, str(theirs.fileno()), str(ros), arm.rstrip("/"), *arguments],
                pass_fds=[theirs.fileno()], start_new_session=True)
        answer = self._link.recv(1 << 16)
        if answer != node.IS_READY:
            self.close()
            raise DeviceError("ROS: " + (answer[1:].decode() or "its process ended, see above"))
        self._link.setblocking(False)

    def publish(self, session: Union[Run, Servo]) -> None:
        """Sends the newest tick of a run or a servo to the topics. Never waits: what ROS does not take in
        time is left out. Raises DeviceError if the node has ended."""
        snapshot = session.snapshot()
        if snapshot is None:
            return
        problem = session.problem if isinstance(session, Run) else session.device_problem
        record = state_record(snapshot, self._before or snapshot.tick, problem, self._frame)
        self._before = snapshot.tick
        try:
            self._link.send(record)
        except BlockingIOError:
            pass
        except OSError:
            raise DeviceError("ROS: the node has ended") from None

    def device(self, info: Optional[DeviceInfo] = None, axes: str = "-y,z,-x",
               pose_rate: float = POSE_RATE) -> "Arm":
        """The device for a Run or a Servo: its pose comes from ARM/measured_cp, its force goes to
        ARM/servo_cf. info: its limits and workspace; axes: of ROS (axes_from()); pose_rate: the smallest
        rate of poses [Hz] with which there is a force. Raises ValueError."""
        if not self._arm:
            raise ValueError("Node(): arm must name the device's namespace")
        return Arm(self._link, info or DeviceInfo(), axes, pose_rate)

    def close(self) -> None:
        """Ends the process, after a force of zero; after 10 s, whatever it does. Any number of times."""
        self._link.close()
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def __enter__(self) -> "Node":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


class Arm:
    """A device that a ROS node moves, for palpate.Run and palpate.Servo. Node.device() makes it."""

    def __init__(self, link: socket.socket, info: DeviceInfo, axes: str, pose_rate: float = POSE_RATE) -> None:
        if not pose_rate > 0:
            raise ValueError(f"pose_rate: {pose_rate} must be above 0 Hz")
        self._link, self._info, self._axes, self._pose_rate = link, info, axes_from(axes), pose_rate
        self._info.name = "ros"
        self._info.has_orientation = self._info.has_gripper = True
        self._info.buttons = 32
        limits = self._info.limits
        limits.delay += DELAY + 0.5 / pose_rate  # a pose that is held acts like a tick of that length
        stable = limits.physical_damping / (0.5 / limits.rate + limits.delay + EXCHANGE)  # docs/force.md
        self._info.stiffness = min(self._info.stiffness, 0.999 * stable)
        self._newest: tuple[Any, ...] = ()
        self._arrivals: collections.deque[float] = collections.deque(maxlen=POSES)
        self._lost = False

    def info(self) -> DeviceInfo:
        """Limits and workspace, as they were given."""
        return self._info

    def _receive(self) -> None:
        try:
            while record := self._link.recv(node.READING.size):
                self._newest = node.READING.unpack(record)
                self._arrivals.append(self._newest[0])
            self._lost = True
        except BlockingIOError:
            pass
        except OSError:
            self._lost = True

    def read(self) -> DeviceReading:
        """The newest pose, as old as it is: after 20 ms the servo gives no force. Raises DeviceError, which
        ends the force, while poses come too slowly or from several nodes."""
        self._receive()
        if self._lost or len(self._arrivals) < POSES:
            return DeviceReading(status="lost" if self._lost else "starting")
        arrived, numbers, opening, buttons, nodes = self._newest[0], self._newest[1:8], *self._newest[8:]
        if nodes > 1:
            raise DeviceError(f"ROS: {nodes} nodes send measured_cp, but the hand has one pose: end all but one")
        passed = arrived - self._arrivals[0]
        if passed * self._pose_rate > POSES - 1:
            raise DeviceError(f"ROS: {(POSES - 1) / passed:.1f} poses per second, where pose_rate asks for "
                              f"{self._pose_rate:g}: send more, or lower it with the stiffness")
        turn = numpy.array(numbers[3:]) if any(numbers[3:]) else numpy.array([0.0, 0.0, 0.0, 1.0])  # none given
        turn[:3] = self._axes @ turn[:3]
        return DeviceReading(position=self._axes @ numbers[:3] * MM, orientation_xyzw=turn, buttons=buttons,
                             opening=None if math.isnan(opening) else opening,
                             age=time.monotonic() - arrived, status="ready")

    def write(self, force: Any, torque: Any) -> None:
        """Does not wait. A force that ROS does not take is left out, and the node ends one that is old."""
        wrench = (*(self._axes.T @ force), *(self._axes.T @ torque / MM))
        try:
            self._link.send(node.IS_WRENCH + node.WRENCH.pack(time.monotonic(), *wrench))
        except BlockingIOError:
            pass
        except OSError:
            self._lost = True
