"""Attack with session files of the viewer: opened with a picture, or refused in one line. Needs a display."""

import copy
import json
import os

from damage import ODD_INTEGERS, bytes_changed
from program import Finding, expect_tidy, judge

SESSION = {
    "format": "palpate-session", "version": 1, "volume": {"volume": "synthetic:sphere:16x16x16"},
    "solid": "above", "isovalue": 50.0, "background": 0.0,
    "settings": {"step_budget": 4096, "forces_on": True,
                 "force": {"stiffness": 0.5, "limit": 3.3}, "friction": {"static": 0.1, "dynamic": 0.1}},
    "device": "mouse", "method": "exact",
    "look": {"surface": True, "volume": False, "slices": True, "surface_opacity": 0.8,
             "surface_colour": [0.9, 0.8, 0.7]},
    "camera": {"focus": [0, 0, 0], "towards_viewer": [0, -1, 0], "up": [0, 0, 1], "half_height": 12},
    "crosshair": [1, 2, 3], "follow": True, "window_low": 0, "window_high": 100, "slices_shown": True}
ODD = [None, True, "", "x" * 5000, [], {}, [0] * 1000, -1, 0, 1e-320, 1e308, -1e308, "inf", "-inf", "nan",
       *ODD_INTEGERS]


def one(program, random, folder, counts):
    display = os.environ.get("DISPLAY")
    if not display:
        counts["skipped: no display"] += 1
        return
    session = damaged(random)
    (folder / "s.json").write_bytes(session)
    ended = program.run(["view", "--session", "s.json", "--window", "320x240", "--screenshot", "p.png"], folder,
                        seconds=60, environment={"DISPLAY": display, "XDG_RUNTIME_DIR": str(folder)})
    judge(ended, {0} if session == json.dumps(SESSION).encode() else {0, 2, 3, 4})
    counts["refused" if ended.status else "opened"] += 1
    if (ended.status == 0) != (folder / "p.png").exists():
        raise Finding(f"a status that disagrees with the picture: {ended}")
    expect_tidy(folder, ended)


def places(value, path=()):
    """Paths to all members."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield (*path, key)
        yield from places(inner, (*path, key))


def damaged(random):
    session = copy.deepcopy(SESSION)
    for _ in range(random.choice((0, 1, 1, 2, 4))):
        path = random.choice(list(places(session)))
        inner = session
        for key in path[:-1]:
            inner = inner[key]
        if random.random() < 0.2 and isinstance(inner, dict):
            del inner[path[-1]]
        else:
            inner[path[-1]] = copy.deepcopy(random.choice(ODD))
    text = json.dumps(session).encode()
    return bytes_changed(text, random) if random.random() < 0.2 else text
