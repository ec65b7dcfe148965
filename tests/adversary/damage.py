"""Damage that reaches deep: sizes that stay consistent, checksums that stay right, numbers at the edge of
what they can be, in the place where a reader expects them."""

import re
import struct
import zlib

ODD_INTEGERS = (0, 1, -1, 2, 3, 127, 255, 256, 32767, 32768, 65535, 65536, 2**31 - 1, 2**31, 2**32 - 1,
                2**32, 2**53, 2**63 - 1, 2**63, 2**64 - 1)
ODD_NUMBERS = ("0", "-0", "1e-320", "-1", "3e38", "-3e38", "1e39", "1e300", "1e-300", "nan", "inf", "-inf",
               "1e999", "", " ", "0x10", "1,5", "1e", "+-1", "٣", "1 2", "9" * 400)


def odd_float32(random):
    return random.choice((0.0, -0.0, 1e-45, 1.2e-38, 3e38, -3e38, float("nan"), float("inf"), float("-inf"),
                          1e-30, 1e30, -1.0, 1.0))


def bytes_changed(data, random):
    """Flips bits, overwrites, cuts, doubles or removes a stretch of bytes."""
    data = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 5))):
        if not data:
            break
        how = random.randrange(6)
        at = random.randrange(min(len(data), random.choice((64, 400, len(data)))))
        if how == 0:
            data[at] ^= 1 << random.randrange(8)
        elif how == 1:
            data[at:at + 4] = struct.pack(random.choice("<>") + "I",
                                          random.choice(ODD_INTEGERS) & 0xFFFFFFFF)
        elif how == 2:
            del data[at:]
        elif how == 3:
            data[at:at] = data[at:at + random.randint(1, 64)]
        elif how == 4:
            del data[at:at + random.randint(1, 64)]
        else:
            data[at:at + 4] = struct.pack("<f", odd_float32(random))
    return bytes(data)


def text_changed(data, random, separator):
    """Changes one value, or one line, of a text header that ends where the samples begin."""
    end = data.find(separator)
    end = len(data) if end < 0 else end
    lines = data[:end].split(b"\n")
    at = random.randrange(len(lines))
    how = random.randrange(6)
    if how == 0:
        lines.insert(at, random.choice(lines))  # twice
    elif how == 1:
        del lines[at]
    elif how == 2:
        lines[at] = lines[at] + b" " * random.choice((1, 100, 70000)) + random.choice((b"", b"1", b"\0"))
    else:
        numbers = list(re.finditer(rb"[-+]?\d[\d.e+-]*", lines[at]))
        if numbers:
            one = random.choice(numbers)
            new = random.choice(ODD_NUMBERS + tuple(map(str, ODD_INTEGERS))).encode()
            lines[at] = lines[at][:one.start()] + new + lines[at][one.end():]
    return b"\n".join(lines) + data[end:]


def repacked(data, random, level=6):
    """A gzip file whose contents are damaged and whose checksum and length are right again; or one whose
    end is not what it should be."""
    inside = bytes_changed(zlib.decompress(data, 31), random)
    packer = zlib.compressobj(level, zlib.DEFLATED, 31)
    packed = packer.compress(inside) + packer.flush()
    if random.random() < 0.2:
        packed += random.choice((b"\0" * 8, b"\x1f\x8b", packed))
    return packed


def bomb(megabytes):
    """A gzip member that unpacks to so many zero bytes, a thousandth of them in the file."""
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    block = b"\0" * (1 << 20)
    return b"".join(packer.compress(block) for _ in range(megabytes)) + packer.flush()
