#!/usr/bin/env python3
"""Measures the cost of a bridge for the servo, in one session, so that drift of the machine affects all turns.

    benchmarks/bridge.py PALPATE VOLUME [--minutes M] [--block S] [--commands N] [RECORD OPTION...]

A session with `--igtl` is recorded. A client takes turns of --block seconds, three at a time in random order:
  with     it is connected, receives everything and sends --commands per second
  without  it is not connected
  beside   it receives as much from a server of its own: the cost of any second program on this machine
How late each tick was woken follows from the recording's times. Prints lateness of each kind, and its ratio
to "without" with the interval that holds 95 % of the ratios of blocks drawn again (bootstrap).
"""

import argparse
import csv
import pathlib
import random
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time

ARMS = ("without", "with", "beside")
PARTS = {"p50": 0.5, "p99": 0.99, "p99.9": 0.999}
MARGIN = 0.1  # of a block at its ends [s]
POSES = 92  # a second, as the bridge sends
POLYNOMIAL = 0x42F0E1EBA9EA3693  # ECMA-182, as OpenIGTLink has it


def checksum(body):
    crc = 0
    for byte in body:
        crc ^= byte << 56
        for _ in range(8):
            crc = (crc << 1 ^ (POLYNOMIAL if crc >> 63 else 0)) & (1 << 64) - 1
    return crc


def string(text):
    body = struct.pack(">HH", 3, len(text)) + text.encode("ascii")
    return struct.pack(">H12s20sQQQ", 1, b"STRING", b"Command", 0, len(body), checksum(body)) + body


class Client:
    """Reads what comes and sends commands; counts poses and replies."""

    def __init__(self, commands):
        self.every = 1 / commands if commands else float("inf")
        self.commands = [string(f"stiffness {value}") for value in (0.4, 0.5)]
        self.poses, self.replies, self.first_command = 0, 0, None

    def take_part(self, port, until):
        with socket.create_connection(("127.0.0.1", port)) as peer:
            last, waiting = time.monotonic(), b""
            while (now := time.monotonic()) < until:
                peer.settimeout(min(0.1, until - now))
                try:
                    waiting = self.counted(waiting + peer.recv(1 << 16))
                except TimeoutError:
                    pass
                now = time.monotonic()
                if now - last < self.every:
                    continue
                last = now
                self.first_command = self.first_command or now
                self.commands.reverse()
                peer.sendall(self.commands[0])

    def counted(self, waiting):
        while len(waiting) >= 58:
            _, kind, name, _, size, _ = struct.unpack(">H12s20sQQQ", waiting[:58])
            if len(waiting) < 58 + size:
                break
            self.poses += name.startswith(b"PalpateHand")
            self.replies += kind.startswith(b"STRING")
            waiting = waiting[58 + size:]
        return waiting


def serve(listener):
    """Sends as much as the bridge does, as often, to one client after the other."""
    names = (b"Beside", b"PalpateProxy", b"PalpateTool", b"PalpateForce", b"Palpate")
    state = b"".join(struct.pack(">H12s20sQQQ", 1, b"TRANSFORM", name, 0, 48, 0) + bytes(48) for name in names)
    while True:
        peer, _ = listener.accept()
        try:
            while True:
                peer.sendall(state)
                time.sleep(1 / POSES)
        except OSError:
            peer.close()


def wait_for(port):
    for _ in range(200):
        try:
            return socket.create_connection(("127.0.0.1", port)).close()
        except ConnectionRefusedError:
            time.sleep(0.05)
    sys.exit("bridge.py: nothing listens")


def session(options, rest, recording):
    """The blocks [(arm, begin, end)] of a session that is recorded, and when a first command was sent."""
    listener = socket.create_server(("127.0.0.1", 0))
    threading.Thread(target=serve, args=(listener,), daemon=True).start()
    port = 18970
    first, client, blocks = Client(5), Client(options.commands), []
    seconds = 60 * options.minutes
    words = [options.palpate, "record", options.volume, "--quiet", "--seconds", str(seconds + 5), "-d", options.device,
             "--igtl", str(port), "-o", str(recording), *rest]
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as program:
        wait_for(port)
        time.sleep(1)
        first.take_part(port, time.monotonic() + 0.3)  # one command: a time that both clocks have
        draw = random.Random(7)
        end = time.monotonic() + seconds
        while time.monotonic() + 3 * options.block < end:
            for arm in draw.sample(ARMS, 3):
                begin = time.monotonic()
                until = begin + options.block
                if arm == "without":
                    time.sleep(options.block)
                else:
                    try:
                        client.take_part(port if arm == "with" else listener.getsockname()[1], until)
                    except OSError as e:
                        sys.exit(f"bridge.py: the session has ended before its time ({e})")
                blocks.append((arm, begin, until))
        program.wait()
    if program.returncode != 0:
        sys.exit(f"bridge.py: status {program.returncode}: {' '.join(words)}")
    rate = client.poses / sum(end - begin for arm, begin, end in blocks if arm == "with")
    if rate < 60 or (options.commands and not client.replies):
        sys.exit(f"bridge.py: {rate:.0f} poses a second, {client.replies} replies")
    print(f"{len(blocks)} blocks of {options.block:g} s; {rate:.0f} poses a second, {client.replies} commands answered")
    return blocks, first.first_command


def lateness(recording):
    """[(time, lateness)] of the ticks, and the time of the first command [s]."""
    ticks, first_command, due, period = [], None, 0.0, 1e-3
    with open(recording, encoding="utf-8") as file:
        rows = csv.reader(file)
        for row in rows:
            if row[0].startswith("# command"):
                first_command = first_command or "next"
            elif row[0][0].isdigit():
                t = float(row[0])
                ticks.append((t, t - due))
                if first_command == "next":
                    first_command = t
                due += period * max(1, int((t - due) / period))  # as the servo does
    return ticks, first_command


def quantiles(blocks):
    values = sorted(value for block in blocks for value in block)
    return [values[int(part * (len(values) - 1))] for part in PARTS.values()]


def ratios(several, alone):
    """Of quantiles, each with its interval."""
    draw = random.Random(11)
    drawn = [[a / b for a, b in zip(quantiles(draw.choices(several, k=len(several))),
                                    quantiles(draw.choices(alone, k=len(alone))))] for _ in range(400)]
    whole = [a / b for a, b in zip(quantiles(several), quantiles(alone))]
    for number, ratio in enumerate(whole):
        values = sorted(one[number] for one in drawn)
        yield ratio, values[10], values[-11]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("palpate")
    parser.add_argument("volume")
    parser.add_argument("--device", default="simulated:loop=yes", help="one that does not finish")
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--block", type=float, default=2, help="[s]")
    parser.add_argument("--commands", type=float, default=10)
    options, rest = parser.parse_known_args()
    with tempfile.TemporaryDirectory() as folder:
        recording = pathlib.Path(folder) / "session.csv"
        blocks, sent = session(options, rest, recording)
        ticks, taken = lateness(recording)
    shift = sent - taken  # the command took a few milliseconds, less than MARGIN
    late = {arm: [] for arm in ARMS}
    times = iter(ticks)
    tick = next(times)
    for arm, begin, end in blocks:
        block = []
        while tick is not None and tick[0] + shift < end - MARGIN:
            if tick[0] + shift >= begin + MARGIN:
                block.append(1e6 * tick[1])
            tick = next(times, None)
        late[arm].append(sorted(block))  # what is sorted in parts is sorted fast again and again
    print(f"{'lateness [us]':<28}" + "".join(f"{part:>10}" for part in PARTS) + f"{'max':>10}{'over 1 ms':>10}{'ticks':>10}")
    for arm in ARMS:
        values = [value for block in late[arm] for value in block]
        print(f"{arm:<28}" + "".join(f"{value:>10.4g}" for value in quantiles(late[arm])) +
              f"{max(values):>10.4g}{sum(value > 1000 for value in values):>10}{len(values):>10}")
    for arm in ARMS[1:]:
        print(f"{arm} / without: " + "; ".join(
            f"{part} {ratio:.2f} ({low:.2f} to {high:.2f})"
            for part, (ratio, low, high) in zip(PARTS, ratios(late[arm], late["without"]))))
    each = [statistics.median(statistics.median(block) for block in late[arm]) for arm in ARMS]
    print("median of the blocks' medians: " + ", ".join(f"{arm} {one:.4g} us" for arm, one in zip(ARMS, each)))


main()
