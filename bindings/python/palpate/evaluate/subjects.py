"""Volumes that experiments are made on, and the methods that they compare."""

import dataclasses
import hashlib
from pathlib import Path
from typing import Callable, Optional

import numpy
import palpate

from .experiment import known


@dataclasses.dataclass(frozen=True)
class Subject:
    """A volume with the level that is felt. exact: the analytic density [data units] at points [mm]."""

    name: str
    field: palpate.Field
    isovalue: float
    exact: Optional[Callable] = None

    @property
    def sign(self):
        return 1 if self.field.solid == "above" else -1

    @property
    def voxel(self):
        """The smallest spacing [mm]."""
        return float(min(self.field.geometry.spacing))

    @property
    def diagonal(self):
        geometry = self.field.geometry
        return float(numpy.linalg.norm(geometry.size * geometry.spacing))


    def excess(self, density):
        """How far densities are in the solid, as a part of the data's range."""
        return self.sign * (density - self.isovalue) / self.field.range

    def excess_at(self, points):
        return self.excess(self.field.value(points))


@dataclasses.dataclass(frozen=True)
class Contestant:
    """A proxy method on a field of one interpolation."""

    name: str
    method: str
    interpolation: str = "linear"

    def felt(self, subject):
        """The subject with the field that this contestant feels."""
        field = subject.field
        return dataclasses.replace(subject, field=palpate.Field(
            field.volume, field.solid, field.background, self.interpolation))

    def proxy(self, subject, start):
        """A proxy on that field, put at a free place [mm]."""
        felt = self.felt(subject)
        return palpate.Proxy(felt.field, felt.isovalue, start, self.method)


CONTESTANTS = {c.name: c for c in (*(Contestant(name, name) for name in palpate.methods()),
                                   Contestant("smooth", "exact", "cubic"))}
GUARDED = ("exact", "paper", "smooth")  # those that must never be in the solid


def linear(name, volume, isovalue, exact=None):
    return Subject(name, palpate.Field(volume, interpolation="linear"), isovalue, exact)


def cube(name, samples, isovalue, interpolation="linear", exact=None):
    """Of a cube of samples 1 mm apart, whose middle is the origin."""
    volume = palpate.Volume(samples, origin=[-0.5 * (len(samples) - 1)] * 3)
    return Subject(name, palpate.Field(volume, interpolation=interpolation), isovalue, exact)


def synthetic(specification, isovalue=None, type=None):
    scene = palpate.scene(specification, type)
    try:
        scene.exact([[0.0, 0.0, 0.0]])
        exact = scene.exact
    except ValueError:
        exact = None
    return linear(scene.name, scene.volume, scene.isovalue if isovalue is None else isovalue, exact)


def reals(names, options):
    """Those of the real volumes that the data folder has; none in the quick mode."""
    return [] if options.quick else [subject for name in names if (subject := real(name, options))]


def real(name, options):
    """A real volume, or None with a note where the data folder lacks it."""
    file, isovalue, sha256, origin = (known("volumes").where(name=name)[0][column] for column in ("file", "level", "sha256", "origin"))
    path = Path(options.data or "") / file
    if not options.data or not path.exists():
        options.note(f"without the volume {name} (no data folder with {file})")
        return None
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    if found != sha256:
        options.note(f"{file} is not the file that the results in docs/results were made with")
    options.used.append((file, found, origin))
    return linear(name, palpate.load(path).volume, isovalue)


def of_text(text):
    """A user's volume: 'head.nrrd@500', 'synthetic:torus'. Raises ValueError, palpate.InputError."""
    found = palpate.subject(text)
    if text.startswith("synthetic:"):
        return synthetic(text.rpartition("@")[0] or text, found.isovalue)
    return Subject(found.name, found.field, found.isovalue)


def of_texts(texts):
    """Volumes of the user, each with a name of its own: a volume at two levels is two."""
    found = [of_text(text) for text in texts]
    names = [subject.name for subject in found]
    return tuple(dataclasses.replace(subject, name=f"{subject.name} at {subject.isovalue:g}") if names.count(subject.name) > 1
                 else subject for subject in found)
