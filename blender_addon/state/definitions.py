# SPDX-License-Identifier: GPL-3.0-or-later
"""Definitions of the properties that describe a requested person. Characters and the operator that adds them share these.

In all functions ``update_for`` goes from a property's name to its update callback; None for properties without callbacks."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from .. import measures

#: The largest seed that fits into Blender's 32-bit integer properties.
LARGEST_SEED = 2**31 - 1
#: Limits of the measure properties, metres. The range that the model accepts is narrower.
SHORTEST, LONGEST = 0.01, 3.0

SEXES = (
    ("FEMALE", "Female", "Generate a female body"),
    ("MALE", "Male", "Generate a male body"),
    ("ANY", "By Measures", "Choose the sex that is more likely for the given measures"),
)
LODS = (
    ("0", "LOD 0 (53 514 Vertices)", "Finest mesh, for close-ups and final renders"),
    ("1", "LOD 1 (13 380 Vertices)", "Mesh to work with. LOD 0 is its subdivision"),
    ("2", "LOD 2 (25 % of LOD 1)", "A quarter of the vertices of LOD 1, for the middle distance"),
    ("3", "LOD 3 (6 % of LOD 1)", "A sixteenth of the vertices of LOD 1, for the far distance"),
)
BONE_NAMES = (
    ("BLENDER", "Blender", "Names such as upper_arm.L, which Blender can mirror"),
    ("NATIVE", "Unreal-like", "Names such as upperarm_l. These are the names that the AnthroNet library uses"),
    ("UNITY", "Unity", "Names such as LeftUpperArm"),
    ("MIXAMO", "Mixamo", "Names such as mixamorig:LeftArm"),
    ("VRM", "VRM", "Names such as leftUpperArm"),
)
FILLS = (
    ("MEAN", "Most Likely", "Predict the most likely values from the given measures"),
    ("SAMPLE", "Random", "Draw plausible values at random. The seed selects them"),
)


def request_properties(update_for=None):
    """The properties of a request other than its measures, by name.

    None of them can be animated: each change generates a new body, which is too slow for every frame."""

    def define(identifier, kind, **definition):
        if update_for is not None:
            definition["update"] = update_for(identifier)
        return kind(options=set(), **definition)

    return {
        "sex": define("sex", EnumProperty, name="Sex", description="Sex of the body", items=SEXES),
        "seed": define(
            "seed",
            IntProperty,
            name="Seed",
            description="Number that selects one of the people with these measures. 0 is the most likely one",
            min=0,
        ),
        "fill": define(
            "fill",
            EnumProperty,
            name="Missing Measures",
            description="How measures that are not given get their values",
            items=FILLS,
        ),
        "nearest": define(
            "nearest",
            BoolProperty,
            name="Nearest Possible",
            description=(
                "If the given measures contradict each other, use the nearest possible ones instead of reporting an error"
            ),
        ),
        "lod": define(
            "lod",
            EnumProperty,
            name="Level of Detail",
            description="Number of vertices of the mesh",
            items=LODS,
            default="1",
        ),
        "accessories": define(
            "accessories",
            BoolProperty,
            name="Eyes, Teeth, Lashes",
            description="Include eyes, teeth, tongue and eyelashes in the mesh",
            default=True,
        ),
        "joint_names": define(
            "joint_names", EnumProperty, name="Bone Names", description="Naming convention of the bones", items=BONE_NAMES
        ),
        "skin_tone": define(
            "skin_tone",
            IntProperty,
            name="Skin Tone",
            description="Step on the Monk Skin Tone scale, 1 (lightest) to 10 (darkest). 0 is the default tone",
            min=0,
            max=10,
        ),
    }


def measure_property(measure, update=None, zero_is_unset=False):
    """The property of a measure. With ``zero_is_unset`` the value 0 stands for a measure that is not given."""
    definition = {} if update is None else {"update": update}
    if zero_is_unset:
        definition.update(description=f"{measure.description}. 0: not given", min=0.0, default=0.0)
    else:
        definition.update(
            description=measure.description,
            min=SHORTEST,
            soft_min=measure.low,
            default=(measure.low + measure.high) / 2,
        )
    return FloatProperty(
        name=f"{measure.label} {measure.side.capitalize()}".strip(),
        unit="LENGTH",
        subtype="DISTANCE",
        precision=4,
        step=0.1,
        max=LONGEST,
        soft_max=measure.high,
        options=set(),
        **definition,
    )


def measure_properties(update_for=None, zero_is_unset=False):
    """The properties of all measures, by name."""
    return {
        measure.name: measure_property(
            measure, None if update_for is None else update_for(measure.name), zero_is_unset
        )
        for measure in measures.all_measures()
    }
