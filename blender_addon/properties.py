# SPDX-License-Identifier: GPL-3.0-or-later
"""What a character keeps in the .blend file: its request, and the report of the last body. It sits on the armature's object.

Changes by a user regenerate the body; changes by the extension itself, under :func:`silent`, do not."""

import json
from contextlib import contextmanager

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import measures

LATENT = 10
SEXES = (
    ("FEMALE", "Female", "A woman's body"),
    ("MALE", "Male", "A man's body"),
    ("ANY", "By Measures", "The sex that the measures are likelier for"),
)
LODS = (
    ("0", "LOD 0 (53 514)", "The finest level: 53 514 vertices"),
    ("1", "LOD 1 (13 380)", "13 380 vertices, to work with; LOD 0 is its subdivision"),
    ("2", "LOD 2 (~25 %)", "A quarter of level 1, for the middle distance"),
    ("3", "LOD 3 (~6 %)", "A sixteenth of level 1, for the far distance"),
)
NAMES = (
    ("BLENDER", "Blender", "upper_arm.L: mirrors by name"),
    ("NATIVE", "Unreal-like", "upperarm_l: the library's own"),
    ("UNITY", "Unity", "LeftUpperArm"),
    ("MIXAMO", "Mixamo", "mixamorig:LeftArm"),
    ("VRM", "VRM", "leftUpperArm"),
)
FILLS = (
    ("MEAN", "Likeliest", "Measures that are not given get their likeliest values beside the given ones"),
    ("SAMPLE", "Drawn", "Measures that are not given are drawn from what is plausible; the seed chooses"),
)

_silent = False


@contextmanager
def silent():
    """Changes of properties inside do not regenerate anything."""
    global _silent
    before, _silent = _silent, True
    try:
        yield
    finally:
        _silent = before


def _changed(settings, context):
    if not _silent and settings.is_character:
        from .services import live

        live.regenerate(settings.id_data, context)


def _measure_changed(name):
    def changed(settings, context):
        if not _silent:
            with silent():
                settings.set_given(name, True)
            _changed(settings, context)

    return changed


def _identity_changed(settings, context):
    if not _silent:
        with silent():
            settings.identity_by_hand = True
        _changed(settings, context)


def _surface_changed(settings, context):
    if not _silent and settings.is_character:
        from .services import live

        live.rebuild(settings.id_data, context)


def _names_changed(settings, _context):
    if not _silent and settings.is_character:
        from .services import rig

        rig.rename(settings.id_data, settings.joint_names.lower())


def _tone_changed(settings, _context):
    if not _silent and settings.is_character:
        from .services import character, material

        material.set_tone(character.mesh_of(settings.id_data), settings.skin_tone)


def _render_changed(settings, _context):
    if not _silent and settings.is_character:
        from .services import character

        character.set_fine_render(settings.id_data, settings.fine_render)


class AnthroMeasureReport(bpy.types.PropertyGroup):
    """What came of one measure. Metres."""

    low90: FloatProperty()
    high90: FloatProperty()
    percentile: FloatProperty()
    residual: FloatProperty()


class AnthroCharacter(bpy.types.PropertyGroup):
    """A character's request and report. Lengths in metres. Each measure is a property of its name, and ``given_`` before its
    name whether it is given."""

    is_character: BoolProperty(options={"HIDDEN"})
    sex: EnumProperty(name="Sex", items=SEXES, update=_changed)
    seed: IntProperty(
        name="Seed",
        description="0 is the likeliest person with these measures, every other number another one",
        min=0,
        update=_changed,
    )
    fill: EnumProperty(name="Open Measures", items=FILLS, update=_changed)
    nearest: BoolProperty(
        name="Nearest Possible",
        description="Take the nearest measures that one person can have instead of refusing those that nobody has",
        update=_changed,
    )
    identity: FloatVectorProperty(
        name="Identity",
        description="What measures leave open: shape of face, distribution of flesh. 0 is the middle, ±1 is usual",
        size=LATENT,
        soft_min=-3.0,
        soft_max=3.0,
        min=-6.0,
        max=6.0,
        update=_identity_changed,
    )
    identity_by_hand: BoolProperty(
        name="Identity by Hand", description="Set the identity by its sliders instead of by the seed", update=_changed
    )
    lod: EnumProperty(name="Detail", items=LODS, default="1", update=_surface_changed)
    accessories: BoolProperty(
        name="Eyes, Teeth, Lashes",
        description="Eyes, teeth, tongue and lashes as parts of the mesh",
        default=True,
        update=_surface_changed,
    )
    fine_render: BoolProperty(
        name="Fine in Renders",
        description="Subdivide the posed surface once more in renders; the viewport stays as fast as it is",
        update=_render_changed,
    )
    joint_names: EnumProperty(
        name="Bone Names", description="What the bones are called", items=NAMES, update=_names_changed
    )
    skin_tone: IntProperty(
        name="Skin Tone",
        description="Step of the Monk skin tone scale; 0 for the default tone",
        min=0,
        max=10,
        update=_tone_changed,
    )
    # The report of the last body.
    error: StringProperty(options={"HIDDEN"})
    warnings: StringProperty(options={"HIDDEN"})
    body_sex: StringProperty(options={"HIDDEN"})
    mass: FloatProperty(name="Mass", unit="MASS", options={"HIDDEN"})
    bmi: FloatProperty(name="Body Mass Index", options={"HIDDEN"})
    report: CollectionProperty(type=AnthroMeasureReport, options={"HIDDEN"})

    def is_given(self, name):
        """Whether a measure is given."""
        return getattr(self, f"given_{name}")

    def set_given(self, name, given):
        """Gives or opens a measure."""
        setattr(self, f"given_{name}", given)

    def measures(self):
        """What every measure is: a dictionary of name to (metres, given)."""
        return {name: (getattr(self, name), self.is_given(name)) for name in measures.names()}

    def set_measures(self, values):
        """Takes measures from such a dictionary; those that are not in it stay. Regenerates nothing."""
        with silent():
            for name, (value, given) in values.items():
                setattr(self, name, value)
                self.set_given(name, given)

    def request(self):
        """The request that the properties describe."""
        from . import library

        return library.anthronet().Request.from_json(json.dumps(self.request_fields()))

    def request_fields(self):
        """The request as the fields of its JSON."""
        fields = {
            "measures": {name: value for name, (value, given) in self.measures().items() if given},
            "seed": self.seed,
            "fill": self.fill.lower(),
            "nearest": self.nearest,
        }
        if self.sex != "ANY":
            fields["sex"] = self.sex.lower()
        if self.identity_by_hand:
            fields["z"] = list(self.identity)
        return fields

    def set_request(self, request):
        """Takes the properties from a request; regenerates nothing."""
        with silent():
            given = request.measures
            self.sex = request.sex.upper() if request.sex else "ANY"
            self.seed = min(request.seed, 2**31 - 1)
            self.fill = request.fill.upper()
            self.nearest = request.nearest
            for name in measures.names():
                self.set_given(name, name in given)
            for name, value in given.items():
                setattr(self, name, value)
            self.identity_by_hand = request.latent is not None
            if request.latent is not None:
                self.identity = request.latent

    def set_report(self, body):
        """Takes the filled values and the report from a body; regenerates nothing."""
        reports = body.measure_reports
        with silent():
            while len(self.report) < len(reports):
                self.report.add()
            for name, told, report in zip(measures.names(), self.report, reports, strict=True):
                if not self.is_given(name):
                    setattr(self, name, report["obtained"])
                for field in ("low90", "high90", "percentile", "residual"):
                    setattr(told, field, report[field])
            if not self.identity_by_hand:
                self.identity = list(body.latent)
            self.body_sex = body.sex
            self.mass, self.bmi = body.mass_kg, body.bmi
            self.warnings = "\n".join(body.report["warnings"])
            self.error = ""


def _add_measures():
    for measure in measures.all_measures():
        AnthroCharacter.__annotations__[f"given_{measure.name}"] = BoolProperty(
            name="Given",
            description="Whether this measure is given; if not, it is filled from those that are",
            update=_changed,
        )
        AnthroCharacter.__annotations__[measure.name] = FloatProperty(
            name=f"{measure.label} {measure.side.capitalize()}".strip(),
            description=measure.description,
            unit="LENGTH",
            subtype="DISTANCE",
            precision=4,
            step=0.1,
            min=0.01,
            max=3.0,
            soft_min=measure.low,
            soft_max=measure.high,
            default=(measure.low + measure.high) / 2,
            update=_measure_changed(measure.name),
        )


def register():
    _add_measures()
    bpy.utils.register_class(AnthroMeasureReport)
    bpy.utils.register_class(AnthroCharacter)
    bpy.types.Object.anthronet = PointerProperty(type=AnthroCharacter, name="AnthroNet")


def unregister():
    del bpy.types.Object.anthronet
    bpy.utils.unregister_class(AnthroCharacter)
    bpy.utils.unregister_class(AnthroMeasureReport)
