# SPDX-License-Identifier: GPL-3.0-or-later
"""What a character keeps in the .blend file: its request, and the report of the last body. It sits on the armature's object.

Changes by a user regenerate the body; changes by the extension itself, under :func:`silent`, do not."""

import json
from contextlib import contextmanager

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    FloatProperty,
    FloatVectorProperty,
    PointerProperty,
    StringProperty,
)

from . import fields, measures

LATENT = 10
#: What no identity is: what was drawn is no longer known, or was given on purpose.
_NOT_DRAWN = [1000.0] * LATENT

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


def _regenerate(settings, context, *names):
    """After a user's change of properties: new bodies for the character, and for those that are edited together with it."""
    if settings.is_character:
        from .services import live

        live.follow(settings.id_data, context, names)


def _request_changed(name):
    def changed(settings, context):
        if not _silent:
            _regenerate(settings, context, name)

    return changed


def _measure_changed(name):
    index = measures.names().index(name)

    def changed(settings, context):
        if _silent:
            return
        # Esc during a drag sets the value of before in the same way. A measure that has the value which it was filled with
        # is open, so that it is open again after Esc.
        filled = settings.report[index].filled if index < len(settings.report) else 0.0
        with silent():
            settings.set_given(name, getattr(settings, name) != filled)
        _regenerate(settings, context, name, f"given_{name}")

    return changed


def _given_changed(name):
    index = measures.names().index(name)

    def changed(settings, context):
        if _silent:
            return
        if index < len(settings.report):
            # The lock was closed on the filled value: it is given from now on.
            settings.report[index].filled = 0.0
        _regenerate(settings, context, name, f"given_{name}")

    return changed


def _identity_changed(settings, context):
    if not _silent:
        with silent():
            # As with measures: Esc brings back what was drawn.
            settings.identity_by_hand = list(settings.identity) != list(settings.drawn)
        _regenerate(settings, context, "identity", "identity_by_hand")


def _by_hand_changed(settings, context):
    if not _silent:
        settings.drawn = _NOT_DRAWN
        _regenerate(settings, context, "identity_by_hand")


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

        if not material.set_tone(character.mesh_of(settings.id_data), settings.skin_tone):
            settings.error = "The skin's material was edited: it keeps its colour"


def _render_changed(settings, _context):
    if not _silent and settings.is_character:
        from .services import character

        character.set_fine_render(settings.id_data, settings.fine_render)


_ON_CHANGE = {
    "lod": _surface_changed,
    "accessories": _surface_changed,
    "joint_names": _names_changed,
    "skin_tone": _tone_changed,
}


class AnthroMeasureReport(bpy.types.PropertyGroup):
    """What came of one measure. Metres."""

    low90: FloatProperty(name="Low", description="Lower end of the 90 % interval, metres", options=set())
    high90: FloatProperty(name="High", description="Upper end of the 90 % interval, metres", options=set())
    percentile: FloatProperty(
        name="Percentile", description="Share of people with less, of the same sex, 0 to 100", options=set()
    )
    residual: FloatProperty(
        name="Residual", description="What the body has more than was given, metres", options=set()
    )
    filled: FloatProperty(
        name="Filled", description="What it was filled with when it was last open, metres; 0 for never", options=set()
    )


class AnthroCharacter(bpy.types.PropertyGroup):
    """A character's request and report. Lengths in metres. Each measure is a property of its name, and ``given_`` before its
    name whether it is given."""

    is_character: BoolProperty(
        name="Character", description="Whether this object is the armature of a character", options={"HIDDEN"}
    )
    identity: FloatVectorProperty(
        name="Identity",
        description="What measures leave open: shape of face, distribution of flesh. 0 is the middle, ±1 is usual",
        size=LATENT,
        soft_min=-3.0,
        soft_max=3.0,
        min=-6.0,
        max=6.0,
        options=set(),
        update=_identity_changed,
    )
    identity_by_hand: BoolProperty(
        name="Identity by Hand",
        description="Set the identity by its sliders instead of by the seed",
        options=set(),
        update=_by_hand_changed,
    )
    drawn: FloatVectorProperty(
        name="Drawn Identity",
        description="The identity that the seed chose last",
        size=LATENT,
        default=_NOT_DRAWN,
        options={"HIDDEN"},
    )
    fine_render: BoolProperty(
        name="Fine in Renders",
        description="Subdivide the posed surface once more in renders; the viewport stays as fast as it is",
        options=set(),
        update=_render_changed,
    )
    # The report of the last body.
    error: StringProperty(name="Error", description="Why the last change was refused", options={"HIDDEN"})
    warnings: StringProperty(name="Warnings", description="What there is to know of the body", options={"HIDDEN"})
    body_sex: StringProperty(name="Sex of the Body", description="Female or male", options={"HIDDEN"})
    mass: FloatProperty(name="Mass", description="Mass of the body", unit="MASS", options={"HIDDEN"})
    bmi: FloatProperty(name="Body Mass Index", description="Kilograms by square metre", options={"HIDDEN"})
    report: CollectionProperty(
        name="Report", description="What came of each measure", type=AnthroMeasureReport, options={"HIDDEN"}
    )

    def is_given(self, name):
        """Whether a measure is given."""
        return getattr(self, f"given_{name}")

    def set_given(self, name, given):
        """Gives or opens a measure."""
        setattr(self, f"given_{name}", given)

    def measures(self):
        """What every measure is: a dictionary of name to (metres, given)."""
        return {name: (_plain(getattr(self, name)), self.is_given(name)) for name in measures.names()}

    def request(self):
        """The request that the properties describe."""
        return from_fields(self.request_fields())

    def request_fields(self, **changed):
        """The request as the fields of its JSON, some of them changed."""
        described = {
            "measures": {name: value for name, (value, given) in self.measures().items() if given},
            "seed": self.seed,
            "fill": self.fill.lower(),
            "nearest": self.nearest,
        }
        if self.sex != "ANY":
            described["sex"] = self.sex.lower()
        if self.identity_by_hand:
            described["z"] = [_plain(number) for number in self.identity]
        described.update(changed)
        return described

    def set_request(self, request):
        """Takes the properties from a request; regenerates nothing. ValueError, and nothing is changed, where they cannot hold
        it."""
        check(request)
        given = request.measures
        with silent():
            self.sex = request.sex.upper() if request.sex else "ANY"
            self.seed = request.seed
            self.fill = request.fill.upper()
            self.nearest = request.nearest
            for name in measures.names():
                self.set_given(name, name in given)
            for name, value in given.items():
                setattr(self, name, value)
            for told in self.report:
                told.filled = 0.0
            self.drawn = _NOT_DRAWN
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
                    told.filled = getattr(self, name)
                for field in ("low90", "high90", "percentile", "residual"):
                    setattr(told, field, report[field])
            if not self.identity_by_hand:
                self.identity = list(body.latent)
                self.drawn = self.identity
            self.body_sex = body.sex
            self.mass, self.bmi = body.mass_kg, body.bmi
            self.warnings = "\n".join(body.report["warnings"])
            self.error = ""


def _plain(number):
    """A single-precision number as it was typed: 1.7, not 1.7000000476837158."""
    return float(f"{number:.7g}")


def from_fields(described):
    """A request from the fields of its JSON."""
    from . import library

    return library.anthronet().Request.from_json(json.dumps(described))


def check(request):
    """ValueError where a request says what properties cannot hold."""
    if request.seed > fields.LARGEST_SEED:
        raise ValueError(f"seed: expected at most {fields.LARGEST_SEED} in Blender, got {request.seed}")
    if request.latent is not None and len(request.latent) != LATENT:
        raise ValueError(f"z: expected {LATENT} numbers, got {len(request.latent)}")
    for name, value in request.measures.items():
        if not fields.SHORTEST <= value <= fields.LONGEST:
            raise ValueError(
                f"{name}: expected {fields.SHORTEST} to {fields.LONGEST} m in Blender, got {value:g} m"
            )


def _complete():
    """Gives the class the properties that it shares with the operator that adds people, and those of the measures."""
    own = AnthroCharacter.__annotations__
    own.update(fields.person(lambda name: _ON_CHANGE.get(name, _request_changed(name))))
    own.update(fields.measure_properties(_measure_changed))
    for name in measures.names():
        own[f"given_{name}"] = BoolProperty(
            name="Given",
            description="Whether this measure is given; if not, it is filled from those that are",
            options=set(),
            update=_given_changed(name),
        )


def register():
    _complete()
    bpy.utils.register_class(AnthroMeasureReport)
    bpy.utils.register_class(AnthroCharacter)
    bpy.types.Object.anthronet = PointerProperty(
        type=AnthroCharacter, name="AnthroNet", description="The person that this armature is"
    )
    bpy.types.Scene.anthronet_edit_together = BoolProperty(
        name="Edit Selected Together",
        description="A change of the active character is one of all selected characters",
        options=set(),
    )


def unregister():
    del bpy.types.Scene.anthronet_edit_together
    del bpy.types.Object.anthronet
    bpy.utils.unregister_class(AnthroCharacter)
    bpy.utils.unregister_class(AnthroMeasureReport)
