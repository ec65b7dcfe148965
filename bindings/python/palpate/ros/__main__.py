"""The command line: python3 -m palpate.ros VOLUME (docs/ros.md)."""

import argparse
import math
import sys
import time

import palpate

from ..errors import exit_status
from . import POSE_RATE, Node


def arguments_from(given):
    parser = argparse.ArgumentParser(
        prog="python3 -m palpate.ros", description="Touch a volume with ROS: hand, proxy, force and status are "
        "topics, and with --arm the device is one of ROS.", epilog="Arguments with := go to ROS: __name:=left, "
        "~status:=/diagnostics")
    parser.add_argument("volume", help="as for palpate touch")
    parser.add_argument("--isovalue", help="a number or a percentage [a suggested one]")
    parser.add_argument("--ros", type=int, choices=(1, 2), default=1, help="version of ROS [%(default)s]")
    hand = parser.add_mutually_exclusive_group()
    hand.add_argument("--device", help="as for palpate touch [simulated]")
    hand.add_argument("--arm", help="namespace of a device of ROS: measured_cp moves the hand, servo_cf gets the force")
    parser.add_argument("--axes", default="-y,z,-x", help="of the arm: what right, up and towards the person are in ROS [%(default)s]")
    parser.add_argument("--pose-rate", type=float, default=POSE_RATE, help="Hz: no force with fewer poses of the arm [%(default)s]")
    parser.add_argument("--model", choices=palpate.simulated_profiles(), help="of the arm: limits and workspace of this model")
    parser.add_argument("--force-limit", type=float, help="N")
    parser.add_argument("--stiffness", type=float, help="N/mm")
    parser.add_argument("--clutch", type=int, help="number of the button [the usual one]")
    parser.add_argument("--dead-man", type=int, help="number of the button [none]")
    parser.add_argument("--record", help="writes a recording")
    parser.add_argument("--rate", type=float, default=100, help="Hz, of the topics [%(default)s]")
    parser.add_argument("--seconds", type=float, default=math.inf, help="ends after this time")
    ros = [text for text in given if ":=" in text]
    rest = [text for text in given if ":=" not in text]
    if "--axes" in rest:  # argparse takes -y,z,-x for an option, unless it is joined
        at = rest.index("--axes")
        rest[at:at + 2] = ["=".join(rest[at:at + 2])]
    options = parser.parse_args(rest)
    if not 1 <= options.rate <= 1000:
        parser.error("--rate: 1 to 1000 Hz")
    return options, ros


def setup_from(options):
    force = palpate.ForceSettings(limit=options.force_limit, stiffness=options.stiffness)
    setup = palpate.Setup(render=palpate.RenderSetup(force=force), clutch=options.clutch, deadman=options.dead_man)
    if options.isovalue is not None:
        setup.isovalue = options.isovalue if options.isovalue.endswith("%") else float(options.isovalue)
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
    loaded = palpate.load(options.volume)
    with Node(ros, arm=options.arm or "", ros=options.ros) as node:
        arm = node.device(model_info(options.model), options.axes, options.pose_rate) if options.arm else None
        run = palpate.Run(loaded, setup_from(options), device=arm)
        if options.record:
            run.record(options.record)
        try:
            with run:
                print(f"touching {options.volume} at isovalue {run.isovalue:g} with {run.device.name}; Ctrl-C ends it",
                      flush=True)
                end = time.monotonic() + options.seconds
                while time.monotonic() < end:
                    node.publish(run)
                    time.sleep(1 / options.rate)
        finally:
            run.stop_recording()


def main():
    options, ros = arguments_from(sys.argv[1:])
    try:
        touch(options, ros)
    except KeyboardInterrupt as error:
        sys.exit(exit_status(error))
    except (palpate.Error, ValueError) as error:
        print(f"palpate.ros: {error}", file=sys.stderr)
        sys.exit(exit_status(error))


if __name__ == "__main__":
    main()
