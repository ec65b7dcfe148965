"""The command line: palpate ros VOLUME (docs/ros.md)."""

import math
import time

import palpate

from ..command_line import ABOVE_ZERO, Kind, Parser, number, one_of, run, say, whole
from . import POSE_RATE, Node, axes_from



def axes(text):
    axes_from(text)
    return text


PARSER = Parser("ros", "Touch a volume with ROS: hand, proxy, force and status are topics", (
    "head.nrrd --device haply", "synthetic:sphere --arm /arm --record hand.csv", "synthetic:sphere --ros 2 __node:=left"))
PARSER.add("volume", kind=Kind("VOLUME"), help="As for palpate touch. Words with := go to ROS, such as __name:=left or ~status:=/diagnostics")
PARSER.add("-i", "--isovalue", kind=Kind("TEXT"), help="Isovalue of the surface, in the data's units (300) or percent of its range (53%)")
PARSER.add("--ros", kind=one_of(("1", "2")), default="1", help="Version of ROS")
PARSER.add("-d", "--device", kind=Kind("TEXT"), help="Device, as for palpate touch")
PARSER.add("--arm", kind=Kind("TEXT"), help="Namespace of a device of ROS instead: measured_cp moves the hand, servo_cf gets the force")
PARSER.add("--axes", kind=Kind("X,Y,Z", axes), default="-y,z,-x", help="Directions of the arm in ROS: right, up and towards the person")
PARSER.add("--pose-rate", kind=ABOVE_ZERO, default=POSE_RATE, help="Least rate of the arm's poses for any force [Hz]")
PARSER.add("--model", kind=one_of(palpate.simulated_profiles()), help="Model whose limits and workspace the arm has")
PARSER.add("--force-limit", kind=number(), help="Largest force [N]")
PARSER.add("-k", "--stiffness", kind=number(), help="Stiffness [N/mm]")
PARSER.add("--clutch", kind=whole(), help="Number of the button that attaches the volume to the hand")
PARSER.add("--dead-man", kind=whole(), help="Number of the button that must be held")
PARSER.add("--record", kind=Kind("FILE.csv"), help="Recording to write")
PARSER.add("--rate", kind=number("a number from 1 to 1000", lambda x: 1 <= x <= 1000), default=100.0, help="Rate of the topics [Hz]")
PARSER.add("--seconds", kind=ABOVE_ZERO, default=math.inf, help="End after this time [s]")


def arguments_from(given):
    """The options, and the words for ROS."""
    rest = [text for text in given if ":=" not in text]
    if "--axes" in rest:  # argparse takes -y,z,-x for an option, unless it is joined
        at = rest.index("--axes")
        rest[at:at + 2] = ["=".join(rest[at:at + 2])]
    options = PARSER.arguments(rest)
    if options.arm and options.device:
        PARSER.error("--arm and --device exclude each other")
    if not options.arm:
        PARSER.warn_of_no_effect(["axes", "pose-rate", "model"], "there is no --arm")
    return options, [text for text in given if ":=" in text]


def setup_from(options):
    force = palpate.ForceSettings(limit=options.force_limit, stiffness=options.stiffness)
    setup = palpate.Setup(render=palpate.RenderSetup(force=force), clutch=options.clutch, deadman=options.dead_man,
                          isovalue=options.isovalue)
    if options.device:
        setup.device = options.device
    return setup


def model_info(name):
    """Limits and workspace of a model, in a light grip; None: those that DeviceInfo() assumes."""
    if name is None:
        return None
    scene = palpate.scene("sphere:8x8x8", "float32")  # the simulated hand needs one
    return palpate.simulated_info(f"simulated:{name},jitter=no,grip=light", palpate.Field(scene.volume), scene.isovalue, 1000)


def touch(options, ros):
    setup, loaded = setup_from(options), palpate.load(options.volume)
    with Node(ros, arm=options.arm or "", ros=int(options.ros)) as node:
        arm = node.device(model_info(options.model), options.axes, options.pose_rate) if options.arm else None
        live = palpate.Run(loaded, setup, device=arm)
        if options.record:
            live.record(options.record)
        try:
            with live:
                say(f"touching {options.volume} at isovalue {live.isovalue:g} with {live.device.name}; Ctrl-C ends it")
                end = time.monotonic() + options.seconds
                while time.monotonic() < end:
                    node.publish(live)
                    time.sleep(1 / options.rate)
        finally:
            live.stop_recording()


def main(words):
    options, ros = arguments_from(words)
    return run(lambda: touch(options, ros))
