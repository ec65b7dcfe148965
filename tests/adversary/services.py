"""Attack through the device's service: it lies, stalls, floods, breaks off. The session goes on or ends as
the contract says, forces stay within the limit, are gone when the service has been silent, and at the end."""

import json
import math
import time

from haply_service import CENTRE, DEVICE, Gone, Service, frame, random_bytes, state, text_frame
from program import Finding, judge

LIMIT_N = 4.0
SILENCE_S = 0.25  # far above the 20 ms that the program allows itself: this machine may stall


def one(program, random, folder, counts):
    name, behaviour = random.choice(list(BEHAVIOURS.items()))
    period = random.choice((1, 7, 50, 300))  # one answer in so many is a bad one

    def misbehave(service, n):
        bad = n > random.choice((0, 30)) and service.random.randrange(period) == 0
        service.misbehaved |= bad
        return behaviour(service, n) if bad else service.good()
    service = Service(random, misbehave)
    ended = program.run(touch(service.port), folder, seconds=20)
    service.close()
    judge(ended, {0, 4})
    counts[name] += 1
    counts["forces"] += len(service.forces)
    counts["forces above 0"] += sum(any(f[2:]) for f in service.forces)
    counts["connections"] += service.connections
    check(service, f"{name}, one in {period}: {ended}")


def touch(port, *more):
    return ["touch", "synthetic:sphere:16x16x16", "--headless", "--normal-priority", "--device",
            f"haply:host=127.0.0.1,port={port},timeout=0.3", "--force-limit", str(LIMIT_N), "--stiffness", "0.5",
            *(more or ("--seconds", "1.5"))]


def check(service, what):
    if service.problems:
        raise Finding(f"{service.problems[0]}; {what}")
    for at, good, *force in service.forces:
        if math.hypot(*force) > LIMIT_N * (1 + 1e-9):
            raise Finding(f"a force of {math.hypot(*force):.3g} N; {what}")
    stale = 0
    for at, good, *force in service.forces:
        stale = stale + 1 if any(force) and at - good > SILENCE_S else 0
        if stale > 10:
            raise Finding(f"a force {at - good:.2f} s after the last good answer; {what}")
    # Over a connection that the service has broken nothing can be sent any more.
    if service.forces and any(service.forces[-1][2:]) and not service.misbehaved:
        raise Finding(f"the last force was {service.forces[-1][2:]}; {what}")


def silence(service, n):
    return None


def a_long_silence(service, n):
    time.sleep(service.random.choice((0.03, 0.2, 0.6)))
    return service.good()


def broken_off(service, n):
    raise Gone


def broken_in_a_frame(service, n):
    raise_after = service.good()
    return raise_after[:service.random.randrange(1, len(raise_after))]


def garbage(service, n):
    return text_frame(service.random.choice(("", "{", "null", "[]", "0", '"x"', "{}", '{"inverse3":7}',
                                             '{"inverse3":[7]}', '{"inverse3":[{}]}', "[" * 100000,
                                             '{"a":' * 5000, "{" * 40 + "}" * 40)))


def binary(service, n):
    return frame(2, random_bytes(service.random, service.random.choice((0, 1, 100, 4000))))


def bad_text(service, n):
    return frame(1, random_bytes(service.random, 60))


def raw_bytes(service, n):
    return random_bytes(service.random, service.random.choice((1, 2, 10, 2000)))


def unfinished_fragments(service, n):
    return frame(1, b'{"inverse3":', final=False) * service.random.choice((1, 50))


def a_huge_frame(service, n):
    return frame(1, b" " * service.random.choice((999_999, 1_000_001, 20_000_000)))


def a_frame_that_claims_much(service, n):
    return bytes([0x81, 127]) + b"\xff" * 8


def control_frames(service, n):
    return frame(9, b"x" * service.random.choice((0, 125))) * 20 + service.good()


def a_close(service, n):
    return frame(8, service.random.choice((b"", b"\x03\xe8", b"\0\0", b"\x03\xe8bye", b"x")))


def a_flood(service, n):
    return service.good() * 500


def numbers_that_are_none(service, n):
    value = service.random.choice(("1e999", "-1e999", "1e308", "null", '"0.1"', "[1]", "{}", "true", "1e-320",
                                   "99999999999999999999"))
    text = json.dumps(state(CENTRE)).replace(str(CENTRE[1]), value)
    return text_frame(text)


def leaps(service, n):
    far = service.random.choice((0.1, 1, 9, 11, 1e6))
    return text_frame(json.dumps(state([far * service.random.uniform(-1, 1) for _ in CENTRE])))


def not_calibrated(service, n):
    status = {k: service.random.random() < 0.5 for k in ("calibrated", "ready", "started")}
    return text_frame(json.dumps(state(CENTRE, status=status)))


def another_device(service, n):
    return text_frame(json.dumps(state(CENTRE, device_id="other")))


def no_device(service, n):
    return text_frame(json.dumps({"inverse3": []}))


def many_devices(service, n):
    devices = [{"device_id": f"{i}", "state": {}} for i in range(2000)]
    return text_frame(json.dumps({"inverse3": devices + state(CENTRE)["inverse3"]}))


def an_error(service, n):
    return text_frame(json.dumps({"error": "x" * service.random.choice((1, 1000)) + "\n\x1b[31m"}))


def parts_missing(service, n):
    whole = state(CENTRE)["inverse3"][0]
    kept = {k: v for k, v in whole.items() if service.random.random() < 0.5}
    return text_frame(json.dumps({"inverse3": [kept | {"device_id": DEVICE}]}))


BEHAVIOURS = {f.__name__.replace("_", " "): f for f in (
    silence, a_long_silence, broken_off, broken_in_a_frame, garbage, binary, bad_text, raw_bytes,
    unfinished_fragments, a_huge_frame, a_frame_that_claims_much, control_frames, a_close, a_flood,
    numbers_that_are_none, leaps, not_calibrated, another_device, no_device, many_devices, an_error,
    parts_missing)}
