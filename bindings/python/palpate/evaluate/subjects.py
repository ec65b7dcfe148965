"""Volumes that experiments are made on, and the methods that they compare."""

import dataclasses
import hashlib
from pathlib import Path
from typing import Callable, Optional

import numpy
import palpate


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

    def physical(self, index):
        """Points [mm] of places [index], (n, 3)."""
        geometry = self.field.geometry
        return geometry.origin + (index * geometry.spacing) @ numpy.asarray(geometry.direction).T

    def index(self, physical):
        geometry = self.field.geometry
        return (physical - geometry.origin) @ numpy.asarray(geometry.direction) / geometry.spacing

    def excess(self, density):
        """How far densities are in the solid, as a part of the data's range."""
        return self.sign * (density - self.isovalue) / self.field.range


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

# Real volumes by name: file, level that is felt, SHA-256 of the file, where it comes from.
UNC = "Stanford volume data archive (University of North Carolina), CThead"
VOLVIS = "volume library of S. Roettger, from the VolVis distribution (SUNY Stony Brook)"
VISIBLE_HUMAN = "slices 0 to 233 of github.com/GalMunGral/visible-human-volume, from the Visible Human Project"
DAISY = "github.com/abelperezd/Volume-Rendering-with-Ray-Marching, Daisy.pvm (O. Ronneberger, Freiburg)"
ORANGE = "github.com/abelperezd/Volume-Rendering-with-Ray-Marching, Orange.pvm (Lawrence Berkeley Laboratory)"
NEURON = "github.com/RivuletStudio/rivuletpy, tests/data/test.tif.zip"
REAL = {"lobster": ("lobster.nrrd", 35, "a23e66d340a0727aa5b7cc8cb92d903840186f5ec7128add667218fe3af681c2", VOLVIS),
        "ct-head": ("cthead_unc.nrrd", 500, "555e214a972cf414c5f071a981a1c32e7414d143986045d70671d55ca6782035", UNC),
        "visible-human": ("visible_human_head.nrrd", 60,
                          "37a3db0bebd45e39f0851e1b398d1e9a83c7605a8aa0b1b68500c9632e3bc8de", VISIBLE_HUMAN),
        "daisy-pollen": ("daisy_pollen.nrrd", 40, "ee597583263a659b06422dbc575e2b598fe5da79764e74f59bd99493f1e2e9d7", DAISY),
        "neuron": ("neuron_confocal.nrrd", 30, "ac320986f5bf7d6797e2f1a45d3d7d9c94671c7fb760bcfb80eccd1431ac5519", NEURON),
        "orange": ("orange.nrrd", 15, "b794c95c7359f6b9d0acb70fff720ff5d160d6a8d97872602fbfca4486a40aa0", ORANGE)}


def synthetic(specification, isovalue=None, type=None):
    scene = palpate.scene(specification, type)
    try:
        scene.exact([[0.0, 0.0, 0.0]])
        exact = scene.exact
    except ValueError:
        exact = None
    return Subject(scene.name, palpate.Field(scene.volume, interpolation="linear"),
                   scene.isovalue if isovalue is None else isovalue, exact)


def reals(names, options):
    """Those of the real volumes that the data folder has."""
    return [subject for name in names if (subject := real(name, options))]


def real(name, options):
    """A real volume, or None with a note where the data folder lacks it."""
    file, isovalue, sha256, origin = REAL[name]
    path = Path(options.data or "") / file
    if not options.data or not path.exists():
        options.note(f"without the volume {name} (no data folder with {file})")
        return None
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    if found != sha256:
        options.note(f"{file} is not the file that the results in docs/results were made with")
    options.used.append((file, found, origin))
    return Subject(name, palpate.Field(palpate.load(path).volume, interpolation="linear"), isovalue)


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
