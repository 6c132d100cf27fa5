# SPDX-License-Identifier: GPL-3.0-or-later
"""The 36 measures: names, groups, ranges. Read from ``data/measures.json``, which packaging takes from the model, so that
Blender starts without loading the model."""

import json
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

GROUPS = ("Head", "Torso", "Arms", "Legs")
_GROUP_OF_WORD = {
    "head": "Head",
    "neck": "Head",
    "arm": "Arms",
    "forearm": "Arms",
    "hand": "Arms",
    "thigh": "Legs",
    "calf": "Legs",
    "foot": "Legs",
    "heel": "Legs",
}


class Measure(NamedTuple):
    """One measure; lengths in metres."""

    name: str
    kind: str
    standard: str
    low: float
    high: float

    @property
    def label(self):
        """Its name for people; the side is told by the column it stands in."""
        return self.name.removesuffix("_left").removesuffix("_right").replace("_", " ").capitalize()

    @property
    def side(self):
        """``left``, ``right`` or nothing."""
        return self.name.rpartition("_")[2] if self.name.endswith(("_left", "_right")) else ""

    @property
    def group(self):
        """The part of the body: one of ``GROUPS``."""
        return _GROUP_OF_WORD.get(self.name.partition("_")[0], "Torso")

    @property
    def mirrored(self):
        """The name of the same measure on the other side."""
        if self.side == "left":
            return self.name.removesuffix("left") + "right"
        if self.side == "right":
            return self.name.removesuffix("right") + "left"
        return self.name

    @property
    def description(self):
        """What a tooltip says."""
        how = {"tape": "Around, as a tape reads it", "slice": "Around at one height, as a tape reads it"}
        text = how.get(self.kind, "From point to point")
        if self.standard:
            text += f". Nearest standard: {self.standard}"
        return text + f". From {self.low:.3f} to {self.high:.3f} m"


@lru_cache(maxsize=1)
def all_measures():
    """All measures in the order of the library."""
    text = (Path(__file__).parent / "data" / "measures.json").read_text(encoding="utf-8")
    return tuple(
        Measure(m["name"], m["kind"], m.get("standard") or "", m["min"], m["max"]) for m in json.loads(text)["measures"]
    )


def names():
    """Their names."""
    return tuple(measure.name for measure in all_measures())
