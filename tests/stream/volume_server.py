#!/usr/bin/env python3
"""A slow and unreliable HTTP server on a free port of the loopback, for tests and experiments.

Serves the files of a folder (--folder), and below /virtual.zarr an OME-Zarr 0.4 image of 1.9 TB whose
chunks are computed when they are asked for: balls of radius 256 voxels, 768 apart,

    value = clamp(round(128 + (256 - distance to the nearest centre) / 2), 0, 255)

with centres at 384 + 768 k voxels along each axis. It has 12288 voxels of 1 um along each axis, uint8, in chunks
of 64^3. Sample i of level L is that formula at voxel (i + 0.5) 2^L - 0.5. Prints its port and runs until its
standard input ends or it is killed. GET /counts gives the numbers of requests so far as JSON.
"""

import argparse
import gzip
import json
import math
import os
import random
import sys
import threading
import time
import urllib.parse
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy

SIZE, CHUNK, PERIOD, RADIUS, LEVELS = 12288, 64, 768, 256, 8


def squares(level, chunk):
    """Squared distances to the nearest centre along one axis, for the samples of a chunk."""
    step = 2**level
    positions = ((chunk * CHUNK + i + 0.5) * step - 0.5 for i in range(CHUNK))
    return [((p - PERIOD / 2 + PERIOD / 2) % PERIOD - PERIOD / 2) ** 2 for p in positions]


class VirtualVolume:
    def __init__(self, compressed):
        self.compressed = compressed
        self.made = {}

    def metadata(self, parts):
        compressor = {"id": "gzip", "level": 1} if self.compressed else None
        if parts == [".zgroup"]:
            return {"zarr_format": 2}
        if parts == [".zattrs"]:
            return {"multiscales": [{
                "version": "0.4",
                "axes": [{"name": n, "type": "space", "unit": "micrometer"} for n in "zyx"],
                "datasets": [{"path": str(level), "coordinateTransformations": [
                    {"type": "scale", "scale": [2**level] * 3},
                    {"type": "translation", "translation": [(2**level - 1) / 2] * 3}]}
                    for level in range(LEVELS)]}]}
        if len(parts) == 2 and parts[1] == ".zarray" and parts[0] in map(str, range(LEVELS)):
            size = SIZE >> int(parts[0])
            return {"zarr_format": 2, "shape": [size] * 3, "chunks": [CHUNK] * 3, "dtype": "|u1",
                    "compressor": compressor, "fill_value": 0, "order": "C", "filters": None,
                    "dimension_separator": "/"}
        return None

    def chunk(self, level, place):
        """Chunks repeat with the balls, so few of them are different."""
        if any(p < 0 or p * CHUNK >= SIZE >> level for p in place):
            return None
        repeat = PERIOD // math.gcd(PERIOD, CHUNK * 2**level)
        key = (level, *(p % repeat for p in place))
        if key not in self.made:
            z, y, x = (numpy.array(squares(level, p)) for p in place)
            square = z[:, None, None] + y[None, :, None] + x[None, None, :]
            values = numpy.floor(128.5 + (RADIUS - numpy.sqrt(square)) / 2)
            data = numpy.clip(values, 0, 255).astype(numpy.uint8).tobytes()
            self.made[key] = gzip.compress(data, 1) if self.compressed else data
        return self.made[key]

    def get(self, path):
        parts = path.split("/")
        made = self.metadata(parts)
        if made is not None:
            return json.dumps(made).encode()
        if len(parts) != 4 or not all(p.isdigit() for p in parts) or int(parts[0]) >= LEVELS:
            return None
        return self.chunk(int(parts[0]), [int(p) for p in parts[1:]])


def in_folder(folder, path):
    file = os.path.realpath(os.path.join(folder, path))
    if not file.startswith(os.path.realpath(folder) + os.sep) or not os.path.isfile(file):
        return None
    with open(file, "rb") as opened:
        return opened.read()


def tag_of(folder, path):
    """The version of a file, as servers tell it."""
    status = os.stat(os.path.join(folder, path))
    return f'"{status.st_ino}-{status.st_mtime_ns}"'


def make_handler(options):
    volume = VirtualVolume(not options.raw)
    chance = random.Random(options.seed)
    lock = threading.Lock()
    asked = {"levels": set(), "chunks": set()}
    together = {"levels": options.levels_together, "chunks": options.chunks_together}
    arrived = threading.Condition(lock)
    counts = {"requests": 0, "at_once": 0, "most_at_once": 0, "failed": 0, "truncated": 0, "lied": 0,
              "endless": 0}

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"
        wbufsize = -1
        disable_nagle_algorithm = True

        def log_message(self, *_):
            pass

        def give(self, status, body=b"", **headers):
            self.send_response(status)
            for name, value in headers.items():
                self.send_header(name.replace("_", "-"), value)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def do_GET(self):
            if self.path == "/counts":
                return self.give(200, json.dumps(counts).encode())
            with lock:
                counts["requests"] += 1
                counts["at_once"] += 1
                counts["most_at_once"] = max(counts["most_at_once"], counts["at_once"])
                waits = options.delay + options.jitter * chance.random()
                draw = chance.random()
                flip = chance.random()
            self.gather()
            time.sleep(waits / 1000)
            with lock:
                counts["at_once"] -= 1  # before the client can have the answer, and ask for more
            try:
                self.answer(draw, flip)
            except (BrokenPipeError, ConnectionResetError):
                self.close_connection = True

        def gather(self):
            """Waits until so many levels, or chunks, have been asked for."""
            parts = self.path.split("?")[0].split("/")[2:]
            kind = "chunks" if len(parts) == 4 else "levels" if len(parts) == 2 else None
            if kind and together[kind] > 0:
                with arrived:
                    asked[kind].add(parts[0] if kind == "levels" else self.path)
                    arrived.notify_all()
                    arrived.wait_for(lambda: len(asked[kind]) >= together[kind])

        def answer(self, draw, flip):
            if options.trailers:
                self.send_response(200)
                self.send_header("Transfer-Encoding", "chunked")
                self.end_headers()
                self.wfile.write(b"1\r\n{\r\n0\r\n")
                while True:
                    self.wfile.write(b"X-More: " + 1000 * b"x" + b"\r\n")
            if options.drips:
                self.send_response(200)
                self.send_header("Content-Length", "1000000")
                self.end_headers()
                while True:
                    self.wfile.write(b" ")
                    self.wfile.flush()
                    time.sleep(0.02)
            if draw < options.failures:
                counts["failed"] += 1
                return self.give(503)
            draw -= options.failures
            if self.path.startswith("/loop"):
                return self.give(302, Location="/loop")
            if self.path.startswith("/file"):
                return self.give(302, Location="file:///etc/hostname")
            path = urllib.parse.unquote(self.path.lstrip("/").split("?")[0])
            name = "virtual.zarr/"
            body = volume.get(path[len(name):]) if path.startswith(name) else (
                in_folder(options.folder, path) if options.folder else None)
            if body is None:
                return self.missing()
            status, body, headers = self.ranged(body)
            if not options.no_tags:
                headers["ETag"] = '"1"' if path.startswith(name) else tag_of(options.folder, path)
            if options.long_tags:
                headers["ETag"] = '"' + "x" * 5000 + '"'
            if options.gzip and status == 200:
                body = gzip.compress(body)
                headers["Content_Encoding"] = "gzip"
            if draw < options.truncated and body:
                counts["truncated"] += 1
                self.send_response(status)
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body[:len(body) // 2])
                self.close_connection = True
                return None
            draw -= options.truncated
            metadata = path.rsplit("/", 1)[-1] in (".zattrs", ".zgroup", ".zarray", "zarr.json")
            if draw < options.lies and body and not metadata:
                counts["lied"] += 1
                at = int(flip * len(body))
                body = body[:at] + bytes([body[at] ^ 0x55]) + body[at + 1:]
            return self.give(status, body, **headers)

        def missing(self):
            if options.missing == "page":
                return self.give(200, b"<!DOCTYPE html><title>Log in</title>")
            if options.missing != "endless":
                return self.give(int(options.missing))
            self.send_response(404)
            self.end_headers()
            self.close_connection = True
            while True:
                self.wfile.write(bytes(1 << 16))
                counts["endless"] += 1

        def ranged(self, body):
            wanted = self.headers.get("Range")
            if not wanted or options.no_ranges or (options.no_suffixes and "=-" in wanted):
                return 200, body, {}
            first, last = wanted.split("=")[1].split("-")
            if options.other_range and first not in ("", "0"):
                first, last = str(int(first) - 1), str(int(last) - 1)
            if options.other_suffix and first == "":
                first, last = "0", str(int(last) - 1)
            begin = max(0, len(body) - int(last)) if first == "" else int(first)
            end = len(body) if first == "" else min(int(last) + 1, len(body))
            size = "*" if options.open_sizes else len(body)
            return 206, body[begin:end], {"Content_Range": f"bytes {begin}-{end - 1}/{size}"}

        def do_HEAD(self):
            body = in_folder(options.folder, urllib.parse.unquote(self.path.lstrip("/")))
            self.send_response(404 if body is None else 200)
            self.send_header("Content-Length", str(len(body or b"")))
            self.end_headers()

    return Handler


class Server(ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 128


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", help="files to serve")
    parser.add_argument("--raw", action="store_true", help="chunks of the virtual volume uncompressed")
    parser.add_argument("--delay", type=float, default=0, help="[ms] before each answer")
    parser.add_argument("--jitter", type=float, default=0, help="[ms] more, by chance")
    parser.add_argument("--failures", type=float, default=0, help="share of answers that are 503")
    parser.add_argument("--truncated", type=float, default=0, help="share of bodies cut in half")
    parser.add_argument("--lies", type=float, default=0, help="share of chunks with a wrong byte")
    parser.add_argument("--no-ranges", action="store_true", help="whole files only")
    parser.add_argument("--no-suffixes", action="store_true", help="no ranges from the end")
    parser.add_argument("--open-sizes", action="store_true", help="sizes for HEAD alone, not with ranges")
    parser.add_argument("--other-range", action="store_true", help="a byte too early, and says so")
    parser.add_argument("--other-suffix", action="store_true", help="the begin for ranges from the end")
    parser.add_argument("--no-tags", action="store_true", help="neither ETag nor Last-Modified")
    parser.add_argument("--long-tags", action="store_true", help="ETags of 5000 characters")
    parser.add_argument("--gzip", action="store_true", help="Content-Encoding: gzip for whole files")
    parser.add_argument("--missing", default="404",
                        help="status of what is not there; 'page' with status 200, or 'endless'")
    parser.add_argument("--levels-together", type=int, default=0,
                        help="levels of the virtual volume that must be asked for before one is answered")
    parser.add_argument("--chunks-together", type=int, default=0, help="the same with chunks")
    parser.add_argument("--trailers", action="store_true", help="endless headers after each body")
    parser.add_argument("--drips", action="store_true", help="50 bytes per second")
    parser.add_argument("--seed", type=int, default=1)
    server = Server(("127.0.0.1", 0), make_handler(parser.parse_args()))
    print(server.server_address[1], flush=True)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    sys.stdin.read()


main()
