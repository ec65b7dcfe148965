#!/usr/bin/env python3
"""Makes data/visible_human_head.nrrd out of the whole head: crops it, and halves it by averaging."""
import argparse
import gzip
import sys
import zlib

CROP = ((152, 344), (128, 344), (14, 234))  # first sample and one past the last: x, y, z
HEADER = """NRRD0004
# CT of a head, Visible Human Project, U.S. National Library of Medicine. See README.md.
type: uint8
dimension: 3
space: left-posterior-superior
sizes: {0} {1} {2}
space directions: (2,0,0) (0,2,0) (0,0,2)
kinds: domain domain domain
encoding: gzip
space origin: ({3},{4},{5})

"""


def read(path):
    """Sizes and samples of an unsigned 8-bit NRRD with gzip encoding."""
    with open(path, "rb") as file:
        header, _, data = file.read().partition(b"\n\n")
    fields = dict(line.split(b": ", 1) for line in header.splitlines() if b": " in line)
    if fields[b"type"] != b"uint8" or fields[b"encoding"] != b"gzip":
        sys.exit(f"{path}: not unsigned 8 bit with gzip")
    return [int(size) for size in fields[b"sizes"].split()], gzip.decompress(data)


def halved(sizes, samples):
    """Means of 2 x 2 x 2 samples within CROP, rounded to the nearest."""
    (x0, x1), (y0, y1), (z0, z1) = CROP

    def row(y, z):
        at = (z * sizes[1] + y) * sizes[0]
        return samples[at + x0 : at + x1]

    for z in range(z0, z1, 2):
        for y in range(y0, y1, 2):
            rows = [row(y, z), row(y + 1, z), row(y, z + 1), row(y + 1, z + 1)]
            columns = [half for each in rows for half in (each[0::2], each[1::2])]
            yield bytes((sum(eight) + 4) // 8 for eight in zip(*columns))


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("head", help="the whole head: 512 x 512 x 234 samples of uint8, 1 mm apart")
    parser.add_argument("output", help="the file to write (NRRD)")
    arguments = parser.parse_args()
    sizes, samples = read(arguments.head)
    if sizes != [512, 512, 234]:
        sys.exit(f"{arguments.head}: has {sizes} samples, not 512 x 512 x 234")
    header = HEADER.format(
        *((end - begin) // 2 for begin, end in CROP), *(begin + 0.5 for begin, _ in CROP)
    )
    packer = zlib.compressobj(9, wbits=31)  # gzip without a time in it: the same bytes every time
    packed = packer.compress(b"".join(halved(sizes, samples))) + packer.flush()
    with open(arguments.output, "wb") as file:
        file.write(header.encode() + packed)


if __name__ == "__main__":
    main()
