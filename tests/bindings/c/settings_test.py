#!/usr/bin/env python3
"""The header of the C interface lists every setting as the library describes it. `--write` lists them anew.

usage: settings_test.py libpalpate-c.so palpate.h [--write]
"""

import ctypes
import math
import pathlib
import re
import sys
import textwrap

library, header = ctypes.CDLL(sys.argv[1]), pathlib.Path(sys.argv[2])
library.palpate_setting_count.restype = ctypes.c_size_t


class Setting(ctypes.Structure):
    _fields_ = [("size_of", ctypes.c_uint32), ("open", ctypes.c_int32), ("name", ctypes.c_char_p),
                ("unit", ctypes.c_char_p), ("about", ctypes.c_char_p), ("least", ctypes.c_double),
                ("most", ctypes.c_double), ("usual", ctypes.c_double)]


def lines_of(setting):
    unit = f"[{setting.unit.decode()}] " if setting.unit else ""
    usual = "inf" if math.isinf(setting.usual) else f"{setting.usual:g}"
    text = f"`{setting.name.decode()}` {unit}{setting.about.decode()} (default: {usual})."
    return textwrap.wrap(text, 106, initial_indent=" *   ", subsequent_indent=" *       ")


lines = []
for index in range(library.palpate_setting_count()):
    one = Setting(ctypes.sizeof(Setting))
    assert library.palpate_setting_describe(ctypes.c_size_t(index), ctypes.byref(one)) == 0
    lines += lines_of(one)
assert len(lines) > 20
text = header.read_text(encoding="utf-8")
begin = "palpate_setting_describe() gives the same.\n"
listed = re.search(re.escape(begin) + r"(.*?) \*/", text, re.DOTALL)
assert listed, "the header has no list of settings"
wanted = "\n".join(lines) + "\n"
if listed.group(1) != wanted:
    if sys.argv[3:] != ["--write"]:
        sys.exit(f"{header} does not list the settings as they are: run {' '.join(sys.argv)} --write\n" + wanted)
    header.write_text(text[:listed.start(1)] + wanted + text[listed.end(1):], encoding="utf-8")
print(f"{library.palpate_setting_count()} settings")
