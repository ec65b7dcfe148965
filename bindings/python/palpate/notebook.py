"""How volumes, fields, meshes and traces look in a notebook: a table of facts and a small picture.
Needs NumPy alone."""

import base64
import html
import struct
import zlib

import numpy

HEIGHT, WIDTH = 64, 320  # of a trace's curve [px]


def _table(about, facts, picture=""):
    rows = "".join(f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
                   f"<td style='text-align:left'>{html.escape(str(value))}</td></tr>"
                   for name, value in facts.items())
    return f"<div><b>{about}</b>{picture}<table>{rows}</table></div>"


def _png(grey):
    """Of an array of uint8, shape (rows, columns)."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + row.tobytes() for row in grey)
    head = struct.pack(">IIBBBBB", grey.shape[1], grey.shape[0], 8, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows))
            + chunk(b"IEND", b""))


def _slice_of(volume):
    """The middle one, at most 128 samples wide."""
    middle = volume.array[volume.array.shape[0] // 2].astype(float)
    step = max(1, -(-max(middle.shape) // 128))
    span = max(volume.maximum - volume.minimum, 1e-300)
    grey = numpy.round(255 * (middle[::step, ::step] - volume.minimum) / span).astype(numpy.uint8)
    code = base64.b64encode(_png(grey)).decode()
    return f"<br/><img alt='middle slice' src='data:image/png;base64,{code}'/>"


def _numbers(values):
    return " x ".join(f"{value:g}" for value in values)


def _facts_of_volume(volume):
    size = volume.geometry.size
    return {"samples": f"{_numbers(size)} {volume.type}",
            "spacing": f"{_numbers(volume.geometry.spacing)} mm",
            "values": f"{volume.minimum:g} to {volume.maximum:g}", "memory": f"{volume.nbytes / 2**20:.1f} MiB"}


def of_volume(volume):
    return _table("Volume", _facts_of_volume(volume), _slice_of(volume))


def of_loaded(loaded):
    volume = loaded.volume
    facts = {"name": loaded.name, "format": loaded.format, **_facts_of_volume(volume)}
    if loaded.time_steps > 1:
        facts["frames"] = loaded.time_steps
    for number, note in enumerate(loaded.notes, 1):
        facts[f"note {number}"] = note
    return _table("LoadedVolume", facts, _slice_of(volume))


def of_field(field):
    facts = {"solid": f"{field.solid} the isovalue", "interpolation": field.interpolation,
             "background": f"{field.background:g}"}
    return _table("Field", {**_facts_of_volume(field.volume), **facts}, _slice_of(field.volume))


def of_mesh(mesh):
    facts = {"vertices": len(mesh.vertices), "triangles": len(mesh.triangles)}
    if len(mesh.vertices):
        facts["size"] = f"{_numbers(numpy.ptp(mesh.vertices, axis=0))} mm"
        facts["encloses"] = f"{mesh.enclosed_volume:g} mm³"
    return _table("Mesh", facts)


def of_trace(trace):
    force = numpy.linalg.norm(trace.force, axis=1)
    facts = {"ticks": len(trace), "in contact": int(trace.constrained.sum())}
    if not len(trace):
        return _table("Trace", facts)
    facts["time"] = f"{trace.t[0]:g} to {trace.t[-1]:g} s"
    facts["largest force"] = f"{force.max():.3g} N"
    groups = numpy.array_split(force, min(WIDTH, len(force)))
    highest = max(force.max(), 1e-300)
    points = " ".join(f"{x * WIDTH / len(groups):.0f},{HEIGHT * (1 - group.max() / highest):.1f}"
                      for x, group in enumerate(groups))
    curve = (f"<br/><svg width='{WIDTH}' height='{HEIGHT}'><polyline fill='none' stroke='currentColor' "
             f"points='{points}'/></svg>")
    return _table("Trace", facts, curve)


def complete(module):
    for kind, text in ((module.Volume, of_volume), (module.LoadedVolume, of_loaded), (module.Field, of_field),
                       (module.Mesh, of_mesh)):
        kind._repr_html_ = text
