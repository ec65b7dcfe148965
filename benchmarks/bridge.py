#!/usr/bin/env python3
"""Measures what a bridge costs the servo: runs with `--igtl`, without it, and beside another program, in turn.

    benchmarks/bridge.py PALPATE VOLUME [--rounds N] [--seconds S] [--commands N] [TOUCH OPTION...]

With the bridge a client takes everything that is sent and sends --commands a second. "beside" has no
bridge, but the same client takes as much from a server of its own: what any second program costs on this
machine. Prints lateness of each run, and the medians over the rounds with their ratio to those without.
"""

import argparse
import json
import socket
import statistics
import struct
import subprocess
import sys
import threading
import time

PARTS = ("p50", "p99", "p99.9", "max")
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


class Client(threading.Thread):
    """Reads to the end; counts the poses."""

    def __init__(self, port, commands):
        super().__init__(daemon=True)
        self.every = 1 / commands if commands else float("inf")
        self.port, self.poses, self.replies, self.seconds = port, 0, 0, 0.0

    def connected(self):
        for _ in range(200):
            try:
                return socket.create_connection(("127.0.0.1", self.port))
            except ConnectionRefusedError:
                time.sleep(0.05)
        sys.exit("bridge.py: nothing listens")

    def run(self):
        with self.connected() as peer:
            begun = last = time.monotonic()
            peer.settimeout(0.1)
            waiting, stiffness = b"", 0
            while True:
                try:
                    came = peer.recv(1 << 16)
                    if not came:
                        break
                    waiting += came
                except TimeoutError:
                    pass
                except OSError:
                    break
                waiting = self.take(waiting)
                now = time.monotonic()
                if now - last < self.every:
                    continue
                last, stiffness = now, 1 - stiffness
                try:
                    peer.sendall(string(f"stiffness {0.4 + 0.1 * stiffness:g}"))
                except OSError:
                    break
            self.seconds = time.monotonic() - begun

    def take(self, waiting):
        while len(waiting) >= 58:
            _, kind, name, _, size, _ = struct.unpack(">H12s20sQQQ", waiting[:58])
            if len(waiting) < 58 + size:
                break
            self.poses += name.startswith(b"PalpateHand")
            self.replies += kind.startswith(b"STRING")
            waiting = waiting[58 + size:]
        return waiting


class Server(threading.Thread):
    """Sends as much as the bridge does, as often."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.listener = socket.create_server(("127.0.0.1", port))
        self.over = threading.Event()

    def run(self):
        peer, _ = self.listener.accept()
        names = (b"PalpateHand", b"PalpateProxy", b"PalpateTool", b"PalpateForce", b"Palpate")
        state = b"".join(struct.pack(">H12s20sQQQ", 1, b"STRING", name, 0, 48, 0) + bytes(48) for name in names)
        while not self.over.wait(1 / 92):
            peer.sendall(state)
        peer.close()
        self.listener.close()


def run(options, rest, port, arm):
    words = [options.palpate, "touch", options.volume, "--headless", "--quiet", "--json",
             "--seconds", str(options.seconds), *rest]
    client = Client(port, options.commands) if arm != "without" else None
    server = Server(port) if arm == "beside" else None
    if arm == "with":
        words += ["--igtl", str(port)]
    if server:
        server.start()
    started = subprocess.Popen(words, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
    if client:
        client.start()
    report = json.loads(started.communicate()[0])
    if server:
        server.over.set()
    if started.returncode != 0:
        sys.exit(f"bridge.py: status {started.returncode}: {' '.join(words)}")
    if client:
        client.join()
        rate = client.poses / client.seconds
        if rate < 60 or (options.commands and client.replies == 0):
            sys.exit(f"bridge.py: {rate:.0f} poses a second, {client.replies} replies")
        report["poses"] = rate
    return report


def row(label, values):
    print(f"{label:<28}" + "".join(f"{v:>10.3g}" for v in values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("palpate")
    parser.add_argument("volume")
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--commands", type=int, default=10)
    options, rest = parser.parse_known_args()
    arms = ("without", "with", "beside")
    reports = {arm: [] for arm in arms}
    print(f"{'[us]':<28}" + "".join(f"{p:>10}" for p in PARTS))
    for number in range(3 * options.rounds):
        # A B C, C B A, ...: what drifts falls on all.
        at = number % 3 if number // 3 % 2 == 0 else 2 - number % 3
        arm = arms[at]
        report = run(options, rest, 18970 + number, arm)
        reports[arm].append(report)
        row(f"lateness {arm}", [report["lateness_ns"][p] / 1e3 for p in PARTS])
    for what in ("lateness_ns", "compute_ns"):
        medians = {arm: [statistics.median(r[what][p] for r in all_of) / 1e3 for p in PARTS]
                   for arm, all_of in reports.items()}
        for arm, values in medians.items():
            row(f"median {what[:-3]} {arm}", values)
        for arm in arms[1:]:
            row(f"ratio {what[:-3]} {arm}", [b / a for a, b in zip(medians["without"], medians[arm])])
    missed = {arm: sum(r["missed"] for r in all_of) for arm, all_of in reports.items()}
    print("ticks missed:", ", ".join(f"{arm} {n}" for arm, n in missed.items()),
          f"of {sum(r['ticks'] for r in reports['with'])} each; poses a second:",
          f"{statistics.median(r['poses'] for r in reports['with']):.0f}")


main()
