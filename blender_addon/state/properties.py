# SPDX-License-Identifier: GPL-3.0-or-later
"""The property groups on the armature object of a character: its request, and the report on the generated body.

Their names are stored in users' files and used in their scripts, so they stay as they are."""

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

from .. import measures
from . import definitions, requests
from .requests import IDENTITY_SIZE, typed_decimal

#: Value of ``drawn`` when no seed chose the identity. No identity slider reaches it.
NO_IDENTITY = [1000.0] * IDENTITY_SIZE

_suspended = False


@contextmanager
def updates_suspended():
    """While this is active, changes of properties call no update callbacks."""
    global _suspended
    before, _suspended = _suspended, True
    try:
        yield
    finally:
        _suspended = before


def are_updates_suspended():
    """Whether update callbacks have to return without doing anything."""
    return _suspended


class AnthroMeasureReport(bpy.types.PropertyGroup):
    """The report on one measure. Lengths in metres."""

    low90: FloatProperty(
        name="Low (m)", description="Lower end of the interval that holds 90 % of people, meters", options=set()
    )
    high90: FloatProperty(
        name="High (m)", description="Upper end of the interval that holds 90 % of people, meters", options=set()
    )
    percentile: FloatProperty(
        name="Percentile", description="Share of people of the same sex with a smaller value, 0 to 100", options=set()
    )
    residual: FloatProperty(
        name="Residual (m)", description="Value of the generated body minus the given value, meters", options=set()
    )
    filled: FloatProperty(
        name="Predicted (m)",
        description="Value that was predicted when the measure was last not given, meters. 0: never predicted",
        options=set(),
    )


class AnthroCharacter(bpy.types.PropertyGroup):
    """The request and the report of a character. Lengths in metres.

    The properties with update callbacks are added in :func:`register`: those of :mod:`definitions`, one for each measure, by
    the measure's name, and one for each measure with the prefix ``given_`` that says whether it is given."""

    is_character: BoolProperty(
        name="Is Character", description="Whether this object is the armature of a character", options={"HIDDEN"}
    )
    drawn: FloatVectorProperty(
        name="Drawn Identity",
        description="The identity that the seed selected last",
        size=IDENTITY_SIZE,
        default=NO_IDENTITY,
        options={"HIDDEN"},
    )
    error: StringProperty(name="Error", description="Why the last change was rejected", options={"HIDDEN"})
    warnings: StringProperty(
        name="Warnings", description="Warnings about the generated body, one on each line", options={"HIDDEN"}
    )
    body_sex: StringProperty(name="Sex of the Body", description="Female or male", options={"HIDDEN"})
    mass: FloatProperty(name="Mass", description="Mass of the body, kilograms", unit="MASS", options={"HIDDEN"})
    bmi: FloatProperty(
        name="Body Mass Index (kg/m²)",
        description="Mass divided by the square of the height, kg/m²",
        options={"HIDDEN"},
    )
    report: CollectionProperty(
        name="Report", description="The report on each measure", type=AnthroMeasureReport, options={"HIDDEN"}
    )

    def is_given(self, name):
        """Whether a measure is given."""
        return getattr(self, f"given_{name}")

    def set_given(self, name, given):
        """Sets whether a measure is given."""
        setattr(self, f"given_{name}", given)

    def measures(self):
        """All measures: a dictionary from name to (metres, given)."""
        return {name: (typed_decimal(getattr(self, name)), self.is_given(name)) for name in measures.names()}

    def request(self):
        """The request that the properties describe."""
        return requests.from_fields(self.request_fields())

    def request_fields(self, **replaced):
        """The fields of the request's JSON form, some of them replaced."""
        fields = {
            "measures": {name: value for name, (value, given) in self.measures().items() if given},
            "seed": self.seed,
            "fill": self.fill.lower(),
            "nearest": self.nearest,
        }
        if self.sex != "ANY":
            fields["sex"] = self.sex.lower()
        if self.identity_by_hand:
            fields["z"] = [typed_decimal(number) for number in self.identity]
        fields.update(replaced)
        return fields

    def set_request(self, request):
        """Sets the properties from a request without generating a body. If they cannot store it, raises ValueError and changes
        nothing."""
        requests.check_storable(request)
        given = request.measures
        with updates_suspended():
            self.sex = request.sex.upper() if request.sex else "ANY"
            self.seed = request.seed
            self.fill = request.fill.upper()
            self.nearest = request.nearest
            for name in measures.names():
                self.set_given(name, name in given)
            for name, value in given.items():
                setattr(self, name, value)
            for entry in self.report:
                entry.filled = 0.0
            self.drawn = NO_IDENTITY
            self.identity_by_hand = request.latent is not None
            if request.latent is not None:
                self.identity = request.latent

    def set_report(self, body):
        """Sets the predicted measures and the report from a generated body."""
        body_reports = body.measure_reports
        with updates_suspended():
            while len(self.report) < len(body_reports):
                self.report.add()
            for name, entry, body_report in zip(measures.names(), self.report, body_reports, strict=True):
                if not self.is_given(name):
                    setattr(self, name, body_report["obtained"])
                    # As the property stores it, in single precision.
                    entry.filled = getattr(self, name)
                for field in ("low90", "high90", "percentile", "residual"):
                    setattr(entry, field, body_report[field])
            if not self.identity_by_hand:
                self.identity = list(body.latent)
                self.drawn = self.identity
            self.body_sex = body.sex
            self.mass, self.bmi = body.mass_kg, body.bmi
            self.warnings = "\n".join(body.report["warnings"])
            self.error = ""


def _properties_with_callbacks(update_for):
    """The properties of a character whose changes have an effect, by name."""
    properties = definitions.request_properties(update_for)
    properties.update(definitions.measure_properties(update_for))
    for name in measures.names():
        properties[f"given_{name}"] = BoolProperty(
            name="Given",
            description="Use this value for the body. If off, the value is predicted from the given measures",
            options=set(),
            update=update_for(f"given_{name}"),
        )
    properties["identity"] = FloatVectorProperty(
        name="Identity",
        description=(
            "Shape of the body and the face that measures leave undetermined. 0 is average, ±1 is common"
        ),
        size=IDENTITY_SIZE,
        soft_min=-3.0,
        soft_max=3.0,
        min=-6.0,
        max=6.0,
        options=set(),
        update=update_for("identity"),
    )
    properties["identity_by_hand"] = BoolProperty(
        name="Identity by Hand",
        description="Set the identity with its sliders instead of the seed",
        options=set(),
        update=update_for("identity_by_hand"),
    )
    properties["fine_render"] = BoolProperty(
        name="Fine in Renders",
        description="Subdivide the posed mesh once more in renders. The viewport is not affected",
        options=set(),
        update=update_for("fine_render"),
    )
    return properties


def register(update_for):
    AnthroCharacter.__annotations__.update(_properties_with_callbacks(update_for))
    bpy.utils.register_class(AnthroMeasureReport)
    bpy.utils.register_class(AnthroCharacter)
    bpy.types.Object.anthronet = PointerProperty(
        type=AnthroCharacter, name="AnthroNet", description="Request and report of the AnthroNet character"
    )
    bpy.types.Scene.anthronet_edit_together = BoolProperty(
        name="Edit Selected Together",
        description="Apply changes of the active character's properties to all selected characters",
        options=set(),
    )


def unregister():
    del bpy.types.Scene.anthronet_edit_together
    del bpy.types.Object.anthronet
    bpy.utils.unregister_class(AnthroCharacter)
    bpy.utils.unregister_class(AnthroMeasureReport)
