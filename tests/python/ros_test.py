"""ROS 1 with a real master and rospy as the peer, ROS 2 with Fast DDS as the peer, and the node in a process of its own."""

import contextlib
import importlib.util
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time
import xmlrpc.client

import numpy
import pytest
from live_test import Still, renderer, until

import palpate

if importlib.util.find_spec("rospy") is None or importlib.util.find_spec("rosmaster") is None:
    pytest.skip("ROS is not installed (scripts/install_packages.sh test)", allow_module_level=True)

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, TwistStamped, WrenchStamped
from ros_peers import Peer, ros_1, ros_2, second_peer
from sensor_msgs.msg import JointState, Joy

from palpate.ros import POSES, Arm, Node, axes_from, velocity
from palpate.ros.__main__ import arguments_from
from palpate.ros import node as records


@pytest.fixture(scope="module", params=[1, 2])
def ros(request, tmp_path_factory):
    """Another node."""
    yield from ros_1(tmp_path_factory.mktemp("log")) if request.param == 1 else ros_2()


def felt(node):
    """The node's device, with a force on a busy machine, too: 0.2 N/mm."""
    return node.device(pose_rate=50)


def newest(ros, topic, kind):
    got = []
    return got, ros.Subscriber(topic, kind, got.append)


def numbers(vector):
    return numpy.array([vector.x, vector.y, vector.z])


def feels(device, session):
    """Whether there is a force that stays; if not, and the hand is where it was told to be, one step of it. A
    force begins again, after readings that were late, below 0.3 N only."""
    snapshot = session.snapshot()
    if snapshot is None or snapshot.device.position[2] != device.height:
        return False
    flags = {name for name, bit in palpate.FORCE_FLAGS.items() if snapshot.tick.force_flags & bit}
    if "waiting" in flags:
        device.height += 1
    elif not flags and numpy.linalg.norm(snapshot.tick.force) < 0.1:
        device.height -= 0.2
    return not flags and numpy.linalg.norm(snapshot.tick.force) >= 0.1


def test_topics_are_the_session_in_metres_newtons_and_the_axes_of_the_volume(ros):
    device = Still(60)
    loaded = palpate.load("synthetic:sphere:40x40x40")
    setup = palpate.Setup(real_time=False, facing="left", isovalue=palpate.scene("sphere:40x40x40").isovalue)
    with Node(arm="", frame="patient", ros=ros.version) as node, palpate.Run(loaded, setup, device=device) as run:
        topics = {"hand/measured_cp": PoseStamped, "hand/measured_cv": TwistStamped,
                  "hand/setpoint_cf": WrenchStamped, "proxy/measured_cp": PoseStamped, "status": DiagnosticArray}
        subscribed = {name: newest(ros, f"/palpate/{name}", kind) for name, kind in topics.items()}
        got = {name: messages for name, (messages, _) in subscribed.items()}
        until(lambda: run.snapshot())
        transform = run.snapshot().transform

        def same():
            node.publish(run)
            tick = run.snapshot().tick
            return feels(device, run) and all(got.values()) and numpy.allclose(
                numbers(got["hand/setpoint_cf"][-1].wrench.force), transform.rotation @ tick.force, atol=1e-6
            ) and numpy.allclose(numbers(got["hand/measured_cp"][-1].pose.position) * 1000, tick.hip, atol=1e-9
            ) and numpy.allclose(numbers(got["proxy/measured_cp"][-1].pose.position) * 1000, tick.scp, atol=1e-6
            )
        until(same)
        assert abs(transform.rotation[2, 2]) < 0.5  # else the axes are not told apart
        assert {messages[-1].header.frame_id for messages in got.values()} == {"patient"}

        def told(level):
            node.publish(run)
            status = got["status"][-1].status[0]
            return status.level == level and {value.key: value.value for value in status.values}

        def pressed():
            values = feels(device, run) and told(0)
            return values and values["mode"] == "constrained" and float(values["force [N]"]) > 0.1
        until(pressed)
        device.read = lambda: palpate.DeviceReading(status="lost")
        until(lambda: told(2))
        assert got["status"][-1].status[0].message == "lost"
        for _, subscriber in subscribed.values():
            subscriber.unregister()


def test_a_device_of_ros_is_felt_and_its_force_ends_with_its_poses(ros):
    with Peer(ros, "/left") as peer, Node(arm="/left", ros=ros.version) as node:
        servo = palpate.Servo(renderer(), felt(node), real_time=False)
        with servo:
            until(lambda: servo.snapshot() and servo.snapshot().device.status == "ready")
            assert servo.snapshot().device.position == pytest.approx((0, 0, peer.height))
            peer.height -= 2.2
            until(peer.pushes)
            assert peer.forces[-1].header.frame_id == "base"
            peer.sends = False
            until(lambda: servo.snapshot().device.age > 0.02 and peer.rests())
            peer.sends = True
            until(peer.pushes)
            peer.stamped = False  # the same pose again and again
            until(lambda: servo.snapshot().device.age > 0.02 and peer.rests())
            peer.stamped = True
            until(peer.pushes)
        until(peer.rests)  # the session has ended, the node has not
        assert node._process.poll() is None


def test_a_run_with_a_device_of_ros_has_its_gripper_and_its_buttons_and_is_recorded(ros, tmp_path):
    with Peer(ros, "/left") as peer, Node(arm="/left/", ros=ros.version) as node:
        run = palpate.Run(palpate.load("synthetic:sphere:40x40x40"), palpate.Setup(real_time=False, clutch=2),
                          device=felt(node))
        run.record(tmp_path / "hand.csv")
        with run:
            until(lambda: run.snapshot() and run.snapshot().device.status == "ready")
            assert run.device.name == "ros" and run.snapshot().device.opening is None
            peer.opening, peer.buttons = 0.25, [0, 1]
            until(lambda: run.snapshot().clutched and run.snapshot().device.opening == 0.25)
            assert run.snapshot().device.buttons == 2
            peer.buttons = [1, 2]  # the second was clicked and is not held
            until(lambda: not run.snapshot().clutched and run.snapshot().device.buttons == 1)
            peer.lose_buttons_and_gripper()  # nobody holds the button
            until(lambda: run.snapshot().device.buttons == 0 and run.snapshot().device.opening is None)
            # It is back, and has not said anything.
            peer.joy = ros.Publisher("/left/button", Joy, queue_size=1)
            peer.gripper = ros.Publisher("/left/gripper/measured_js", JointState, queue_size=1)
            until(lambda: peer.joy.get_num_connections() and peer.gripper.get_num_connections())
            for place in (peer.height + 1, peer.height + 2):
                peer.height = place
                until(lambda: run.snapshot().device.position[2] == pytest.approx(place))
                assert run.snapshot().device.buttons == 0 and run.snapshot().device.opening is None
        assert run.stop_recording() > 0
        assert palpate.validate(tmp_path / "hand.csv")


def test_without_the_process_of_ros_the_device_is_lost_and_the_servo_goes_on(ros):
    with Peer(ros, "/left") as peer, Node(arm="/left", ros=ros.version) as node:
        with palpate.Servo(renderer(), felt(node), real_time=False) as servo:
            peer.height -= 2.2
            until(peer.pushes)
            # Hanging, and then gone.
            os.kill(node._process.pid, signal.SIGSTOP)
            until(lambda: servo.snapshot().device.age > 0.02 and not servo.snapshot().tick.force.any())
            os.kill(node._process.pid, signal.SIGCONT)
            until(lambda: servo.snapshot().tick.force[2] > 0.2)
            os.kill(node._process.pid, signal.SIGKILL)
            until(lambda: servo.snapshot().device.status == "lost")
            before = servo.snapshot().number
            until(lambda: servo.snapshot().number > before + 100)
            assert not servo.snapshot().tick.force.any() and servo.device_problem == ""
            with pytest.raises(palpate.DeviceError, match="the node has ended"):
                node.publish(servo)


@pytest.mark.parametrize("end", [signal.SIGSTOP, signal.SIGKILL])
def test_a_session_that_hangs_or_is_killed_leaves_no_force(ros, end):
    with Peer(ros, "/left") as peer:
        peer.height = 100  # the hand begins outside
        program = subprocess.Popen([os.environ["PALPATE"], "ros", "synthetic:sphere:40x40x40",
                                    "--ros", str(ros.version),
                                    "--arm", "/left", "--pose-rate", "10", "__name:=killed"], stdout=subprocess.PIPE, text=True)
        try:
            assert "with ros" in program.stdout.readline()
            until(lambda: peer.wrench.get_num_connections() == 1 and peer.forces)

            lowest, reach = 0, 3

            def presses():
                """Down to the first force, then down there again and again: a force that late poses ended begins low, so each time from
                farther out."""
                nonlocal lowest, reach
                time.sleep(0.01)
                if not lowest and not peer.rests():
                    lowest = peer.height - 8  # 0.05 N/mm: enough for a force that counts
                peer.height -= 0.1 if lowest else 0.5
                if peer.height < lowest:
                    peer.height = lowest + reach if lowest else 100
                    reach = min(2 * reach, 100)
                return peer.pushes()
            until(presses)
            program.send_signal(end)
            if end == signal.SIGKILL:
                until(lambda: peer.wrench.get_num_connections() == 0)
            until(peer.rests)
        finally:
            program.kill()
            program.communicate()


@pytest.mark.parametrize("end", ["rosnode kill", "a node of the same name", "SIGTERM"])
def test_a_node_that_ros_ends_leaves_no_force_and_the_device_is_lost(ros, end):
    if ros.version == 2 and end != "SIGTERM":
        pytest.skip("ROS 2 ends no node")
    with Peer(ros, "/left") as peer, Node(arm="/left", ros=ros.version) as node:
        with palpate.Servo(renderer(), felt(node), real_time=False) as servo:
            until(lambda: servo.snapshot() and servo.snapshot().device.status == "ready")
            peer.height -= 2.2
            until(peer.pushes)
            if end == "SIGTERM":
                node._process.terminate()
            elif end == "rosnode kill":
                import rosgraph
                place = rosgraph.Master("/peer").lookupNode("/palpate")
                with contextlib.suppress(OSError):  # it may end before it answers
                    xmlrpc.client.ServerProxy(place).shutdown("/peer", "killed by a test")
            else:
                Node().close()
            until(peer.rests)
            until(lambda: servo.snapshot().device.status == "lost" and not servo.snapshot().tick.force.any())
            with pytest.raises(palpate.DeviceError, match="the node has ended"):
                node.publish(servo)
            node._process.wait()
            assert peer.rests()


def test_states_do_not_keep_a_force_that_the_session_does_not_renew():
    session, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    theirs.settimeout(None)  # rospy gives every socket one
    now, pushed, told = [100.0], [], []

    class Topics:
        def tell(self, state):
            told.append(state)

    class PushedArm:
        def push(self, wrench):
            pushed.append((now[0], tuple(wrench)))

    def wait(*_):
        """A state each 5 ms; the force is not renewed after the first."""
        now[0] += 0.005
        if now[0] < 100.1:
            session.send(records.IS_STATE)
        else:
            session.close()

    session.send(records.IS_WRENCH + records.WRENCH.pack(now[0], 1, 0, 0, 0, 0, 0))
    records.serve(theirs, Topics(), PushedArm(), clock=lambda: now[0], wait=wait)
    assert len(told) > 15
    assert pushed[0][1] == (1, 0, 0, 0, 0, 0)
    assert pushed[1][1] == records.ZERO and pushed[1][0] < 100 + records.SILENCE + 0.01
    assert all(wrench == records.ZERO for _, wrench in pushed[1:])


def test_forces_that_waited_for_the_process_of_ros_are_not_sent(ros):
    with Peer(ros, "/left") as peer, Node(arm="/left", ros=ros.version) as node:
        arm = node.device()
        until(lambda: peer.forces)
        os.kill(node._process.pid, signal.SIGSTOP)
        for _ in range(1000):  # more than the link holds
            arm.write((0, 0, 1), (0, 0, 0))
        time.sleep(2 * records.SILENCE)
        before = len(peer.forces)
        os.kill(node._process.pid, signal.SIGCONT)
        until(lambda: len(peer.forces) > before + 10)
        assert not any(force.wrench.force.x for force in peer.forces)
        assert not arm._lost


def test_axes_are_rotations_and_work_is_the_same_in_both(ros):
    random = numpy.random.default_rng(5)
    with Node(arm="/left", ros=ros.version) as node:
        for text in ("-y,z,-x", "x,y,z", "y, z, x", "-x,-y,z"):
            arm = node.device(axes=text)
            arm._link, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            arm._link.setblocking(False)
            place, force, torque = random.normal(size=(3, 3))
            turn = random.normal(size=4)
            turn /= numpy.linalg.norm(turn)
            now = time.monotonic()
            for number in range(POSES):
                theirs.send(records.READING.pack(now + 0.001 * number, *place, *turn, math.nan, 0, 1))
            reading = arm.read()
            arm.write(force, torque)
            _, *wrench = records.WRENCH.unpack_from(theirs.recv(1000), 1)
            assert force @ reading.position / 1000 == pytest.approx(numpy.dot(wrench[:3], place))  # N m
            axis = reading.orientation_xyzw[:3] * reading.orientation_xyzw[3]  # either sign is the same turn
            assert torque @ axis / 1000 == pytest.approx(numpy.dot(wrench[3:], turn[:3] * turn[3]))
            assert abs(reading.orientation_xyzw[3]) == pytest.approx(abs(turn[3]))
            theirs.send(records.READING.pack(now + 0.001 * POSES, *place, 0, 0, 0, 0, math.nan, 0, 1))
            assert tuple(arm.read().orientation_xyzw) == (0, 0, 0, 1)  # none given
            theirs.close()
            assert arm.read().status == "lost"
    for wrong in ("y,z,-x", "x,x,y", "x,y", "x,y,up", "", "x,-y,z"):
        with pytest.raises(ValueError, match="axes"):
            axes_from(wrong)
    with Node(ros=ros.version) as node, pytest.raises(ValueError, match="arm"):
        node.device()


def test_the_command_line_takes_axes_in_both_forms():
    for given in (["--axes", "-y,z,-x"], ["--axes=-y,z,-x"]):
        options, ros = arguments_from(["head.nrrd", *given, "__name:=left", "--arm", "/left"])
        assert (options.axes, options.arm, ros) == ("-y,z,-x", "/left", ["__name:=left"])


def test_poses_that_come_too_slowly_for_the_stiffness_give_no_force():
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    ours.setblocking(False)
    with ours, theirs:
        arm = Arm(ours, palpate.DeviceInfo(), "x,y,z", pose_rate=100)
        limits = arm.info().limits
        assert limits.delay == pytest.approx(0.002 + 0.005)
        assert arm.info().stiffness <= limits.physical_damping / (0.5 / limits.rate + limits.delay)
        arrived = time.monotonic()

        def arrive(count, period, nodes=1):
            nonlocal arrived
            for _ in range(count):
                arrived += period
                theirs.send(records.READING.pack(arrived, 0, 0, 0, 0, 0, 0, 1, math.nan, 0, nodes))
        arrive(POSES - 1, 0.009)
        assert arm.read().status == "starting"
        arrive(1, 0.009)
        assert arm.read().status == "ready"
        arrive(1, 0.03)  # a single one that is late
        assert arm.read().status == "ready"
        arrive(POSES, 0.011)
        with pytest.raises(palpate.DeviceError, match="90.9 poses per second, where pose_rate asks for 100"):
            arm.read()
        arrive(POSES, 0.009)
        assert arm.read().status == "ready"
        arrive(1, 0.009, nodes=2)
        with pytest.raises(palpate.DeviceError, match="2 nodes send measured_cp"):
            arm.read()
        arrive(1, 0.009)
        assert arm.read().status == "ready"
        for rate in (0, -1, math.nan):
            with pytest.raises(ValueError, match="pose_rate"):
                Arm(ours, palpate.DeviceInfo(), "x,y,z", pose_rate=rate)


def test_a_second_node_that_sends_poses_ends_the_force(ros):
    with Peer(ros, "/left") as peer, Node(arm="/left", ros=ros.version) as node:
        with palpate.Servo(renderer(), felt(node), real_time=False) as servo:
            until(lambda: servo.snapshot() and servo.snapshot().device.status == "ready")
            peer.height -= 2.2
            until(peer.pushes)
            with second_peer(ros, "/left/measured_cp"):
                until(lambda: "2 nodes send measured_cp" in servo.device_problem)
                until(peer.rests)
            until(peer.pushes)


def test_a_volume_that_is_not_there_and_ctrl_c_have_their_exit_statuses(ros, tmp_path):
    command = [os.environ["PALPATE"], "ros", "--ros", str(ros.version)]
    lost = subprocess.run([*command, tmp_path / "lost.nrrd"], stderr=subprocess.PIPE, text=True, check=False)
    assert lost.returncode == 3 and lost.stderr == f"palpate: {tmp_path / 'lost.nrrd'}: does not exist; check the name\n"
    recorded = tmp_path / "hand.csv"
    session = subprocess.Popen([*command, "synthetic:sphere:16x16x16", "--record", recorded], stdout=subprocess.PIPE)
    assert session.stdout.readline().startswith(b"touching")
    session.send_signal(signal.SIGINT)
    assert session.wait() == 130
    session.stdout.close()
    assert palpate.validate(recorded)["complete"]


SLOW_START = """
import sys, time
sys.path.insert(0, sys.argv.pop(1))
import node
make = node.Arm.__init__
def slowly(arm, *arguments):
    make(arm, *arguments)
    time.sleep(1)
node.Arm.__init__ = slowly
node.main(*sys.argv[1:])
"""


def test_no_pose_comes_before_the_answer_that_the_node_is_ready(ros):
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with Peer(ros, "/left"), ours:
        with theirs:
            process = subprocess.Popen([sys.executable, "-c", SLOW_START, os.path.dirname(records.__file__),
                                        str(theirs.fileno()), str(ros.version), "/left"],
                                       pass_fds=[theirs.fileno()])
        assert ours.recv(1000) == records.IS_READY
        assert len(ours.recv(1000)) == records.READING.size
        ours.close()
        process.wait()


def test_a_node_that_has_ended_is_gone_for_its_peers_before_its_lease_ends(ros, monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", '<Domain Id="any"><Discovery><LeaseDuration>3600s</LeaseDuration></Discovery></Domain>')
    with Peer(ros, "/left") as peer:
        with Node(arm="/left", ros=ros.version):
            until(lambda: peer.wrench.get_num_connections() == 1)
        until(lambda: peer.wrench.get_num_connections() == 0)


def test_names_and_settings_of_ros_2_are_those_of_its_command_line_and_its_environment(monkeypatch):
    monkeypatch.syspath_prepend(os.path.dirname(records.__file__))
    from ros2 import HASHES, LOOPBACK, Names, settings
    plain, renamed = Names([]), Names(["__ns:=/lab/", "__node:=left", "~hand/measured_cp:=/hand", "status:=/diagnostics"])
    names = ("~hand/measured_cp", "~/hand/measured_cp", "/arm/servo_cf", "status")
    assert [plain.topic(name) for name in names] == [
        "rt/palpate/hand/measured_cp", "rt/palpate/hand/measured_cp", "rt/arm/servo_cf", "rt/status"]
    assert [renamed.topic(name) for name in (*names, "~status")] == [
        "rt/hand", "rt/hand", "rt/arm/servo_cf", "rt/diagnostics", "rt/lab/left/status"]
    assert settings({}) == HASHES
    assert settings({"ROS_LOCALHOST_ONLY": "1", "CYCLONEDDS_URI": "file:mine.xml"}) == f"{HASHES},{LOOPBACK},file:mine.xml"


def test_a_process_of_ros_that_hangs_is_ended(ros):
    node = Node(ros=ros.version)
    os.kill(node._process.pid, signal.SIGSTOP)
    closing = threading.Thread(target=node.close, daemon=True)
    closing.start()
    until(lambda: node._process.poll() is not None)
    closing.join()


def test_the_velocity_is_that_between_two_ticks():
    class Tick:
        def __init__(self, at, hip, angle):
            self.time, self.hip = at, numpy.array(hip)
            self.hand_orientation_xyzw = numpy.array([0, math.sin(angle / 2), 0, math.cos(angle / 2)])

    before, after = Tick(1, (1, 2, 3), 0.2), Tick(1.5, (2, 2, 1), 0.5)
    linear, angular = velocity(before, after)
    assert linear == pytest.approx((2, 0, -4)) and angular == pytest.approx((0, 0.6, 0))
    after.hand_orientation_xyzw *= -1  # the same orientation
    assert velocity(before, after)[1] == pytest.approx((0, 0.6, 0))
    for linear in (*velocity(after, after), *velocity(after, before)):
        assert not linear.any()
