"""A stand-in for the service of a haptic device (JSON over a WebSocket), written from its public
documentation, that misbehaves on request and keeps every force that it was sent."""

import base64
import hashlib
import json
import math
import os
import socket
import struct
import threading
import time

GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
CENTRE = (-0.007, -0.068, 0.130)  # of the workspace [m, service axes]
DEVICE = "A1B2"


class Service:
    """`behaviour(service, n)` is called with the number of the answer to give; it returns the bytes of one
    or more frames, None for silence, or raises Gone to break the connection."""

    def __init__(self, random, behaviour):
        self.random, self.behaviour = random, behaviour
        self.forces = []  # (time of arrival, last good answer before it, x, y, z)
        self.last_good = 0.0
        self.problems = []
        self.connections = 0
        self.misbehaved = False  # in the last connection
        self.begun = time.monotonic()
        self.closing = False
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.thread = threading.Thread(target=self.accept, daemon=True)
        self.thread.start()

    def close(self):
        """Ends the service. What the program sent before it ended is read to the end first."""
        time.sleep(0.1)
        self.closing = True
        self.listener.close()
        self.thread.join(5)

    def accept(self):
        self.listener.settimeout(0.1)
        while not self.closing:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                continue
            self.connections += 1
            self.misbehaved = False
            try:
                connection.settimeout(10)  # a busy machine may take long to ask
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self.serve(connection)
            except (OSError, Gone, ValueError, struct.error):
                pass
            connection.close()

    def serve(self, connection):
        self.shake_hands(connection)
        connection.settimeout(0.2)
        self.answer(connection, 0)
        n = 1
        while not self.closing:
            message = read_message(connection, lambda: self.closing)
            if message is None:
                return
            self.keep_force(message)
            try:
                self.answer(connection, n)
            except OSError:
                pass  # the program has ended; what it sent last may still have to be read
            n += 1

    def shake_hands(self, connection):
        head = b""
        while b"\r\n\r\n" not in head:
            more = connection.recv(4096)
            if not more:
                raise Gone
            head += more
        key = next(line.split(b":", 1)[1].strip() for line in head.split(b"\r\n")
                   if line.lower().startswith(b"sec-websocket-key:"))
        accept = base64.b64encode(hashlib.sha1(key + GUID).digest())
        connection.sendall(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                           b"Sec-WebSocket-Accept: " + accept + b"\r\n\r\n")

    def answer(self, connection, n):
        frames = self.behaviour(self, n)
        if frames is not None:
            connection.sendall(frames)

    def keep_force(self, message):
        try:
            commands = json.loads(message)["inverse3"][0]["commands"]
        except (ValueError, KeyError, IndexError, TypeError):
            self.problems.append(f"a message that is not understood: {message[:200]!r}")
            return
        force = commands.get("set_cursor_force", {})
        vector = force.get("values") or force.get("vector") or {}
        values = [vector.get(c, math.nan) for c in "xyz"]
        if not all(isinstance(v, (int, float)) and math.isfinite(v) for v in values):
            self.problems.append(f"a force that is no number: {message[:200]!r}")
            return
        self.forces.append((time.monotonic(), self.last_good, *values))

    def good(self):
        """A frame with the hand's true position, which moves in and out of the middle."""
        t = time.monotonic() - self.begun
        reach = 0.18 * math.cos(2 * math.pi * 0.7 * t)  # begins outside the body
        at = (CENTRE[0] + 0.01 * math.sin(3 * t), CENTRE[1] + reach, CENTRE[2])
        self.last_good = time.monotonic()
        return text_frame(json.dumps(state(at)))


class Gone(Exception):
    """The connection ends here."""


def state(at, **changes):
    device = {"device_id": DEVICE, "config": {"type": "inverse3"},
              "state": {"cursor_position": dict(zip("xyz", at)),
                        "cursor_velocity": {"x": 0, "y": 0, "z": 0}},
              "status": {"calibrated": True, "ready": True, "started": True}}
    device.update(changes)
    return {"session_id": 7, "inverse3": [device]}


def frame(opcode, data, final=True):
    head = bytes([opcode | (0x80 if final else 0)])
    if len(data) < 126:
        return head + bytes([len(data)]) + data
    if len(data) < 65536:
        return head + struct.pack(">BH", 126, len(data)) + data
    return head + struct.pack(">BQ", 127, len(data)) + data


def text_frame(text):
    return frame(1, text.encode())


def exactly(connection, count, ended):
    data = b""
    while len(data) < count:
        try:
            more = connection.recv(count - len(data))
        except socket.timeout:
            if ended():
                return None
            continue
        if not more:
            return None
        data += more
    return data


def read_message(connection, ended):
    """The text of the next message, or None at the end of the connection."""
    while True:
        head = exactly(connection, 2, ended)
        if head is None:
            return None
        size = head[1] & 127
        if size > 125:
            more = exactly(connection, 2 if size == 126 else 8, ended)
            if more is None:
                return None
            size = int.from_bytes(more, "big")
        mask = exactly(connection, 4, ended)
        data = exactly(connection, size, ended) if mask is not None else None
        if data is None:
            return None
        key = (mask * (size // 4 + 1))[:size]
        data = (int.from_bytes(data, "big") ^ int.from_bytes(key, "big")).to_bytes(size, "big")
        if head[0] & 15 == 8:  # close: answered in kind
            connection.sendall(frame(8, data[:2]))
            return None
        if head[0] & 15 == 1:
            return data.decode()


def random_bytes(random, count):
    return bytes(random.randrange(256) for _ in range(count)) if count < 5000 else os.urandom(count)
