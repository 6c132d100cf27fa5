# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person is asked for: the definitions of the properties that characters and the operator that adds them share."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from . import measures

#: The largest seed that Blender's whole numbers hold.
LARGEST_SEED = 2**31 - 1
#: What a measure can be at all, metres; what the model takes is narrower.
SHORTEST, LONGEST = 0.01, 3.0

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


def person(update=None):
    """The properties but for the measures, by name. ``update``: from a property's name to what is called after a change.

    None can be animated: a change makes a new body, which no animation system waits for."""

    def made(identifier, kind, **definition):
        if update is not None:
            definition["update"] = update(identifier)
        return kind(options=set(), **definition)

    return {
        "sex": made("sex", EnumProperty, name="Sex", description="Whose body", items=SEXES),
        "seed": made(
            "seed",
            IntProperty,
            name="Seed",
            description="0 is the likeliest person with these measures, every other number another one",
            min=0,
        ),
        "fill": made(
            "fill", EnumProperty, name="Open Measures", description="How open measures are filled", items=FILLS
        ),
        "nearest": made(
            "nearest",
            BoolProperty,
            name="Nearest Possible",
            description="Take the nearest measures that one person can have instead of refusing those that nobody has",
        ),
        "lod": made(
            "lod", EnumProperty, name="Detail", description="How many vertices the mesh has", items=LODS, default="1"
        ),
        "accessories": made(
            "accessories",
            BoolProperty,
            name="Eyes, Teeth, Lashes",
            description="Eyes, teeth, tongue and lashes as parts of the mesh",
            default=True,
        ),
        "joint_names": made(
            "joint_names", EnumProperty, name="Bone Names", description="What the bones are called", items=NAMES
        ),
        "skin_tone": made(
            "skin_tone",
            IntProperty,
            name="Skin Tone",
            description="Step of the Monk skin tone scale; 0 for the default tone",
            min=0,
            max=10,
        ),
    }


def measure(one, update=None, may_be_open=False):
    """The property of a measure; with ``may_be_open`` 0 stands for a measure that is not given."""
    definition = {} if update is None else {"update": update}
    if may_be_open:
        definition.update(description=f"{one.description}; 0 leaves it open", min=0.0, default=0.0)
    else:
        definition.update(
            description=one.description, min=SHORTEST, soft_min=one.low, default=(one.low + one.high) / 2
        )
    return FloatProperty(
        name=f"{one.label} {one.side.capitalize()}".strip(),
        unit="LENGTH",
        subtype="DISTANCE",
        precision=4,
        step=0.1,
        max=LONGEST,
        soft_max=one.high,
        options=set(),
        **definition,
    )


def measure_properties(update=None, may_be_open=False):
    """The properties of all measures by name. ``update`` as of :func:`person`."""
    return {
        one.name: measure(one, None if update is None else update(one.name), may_be_open)
        for one in measures.all_measures()
    }
