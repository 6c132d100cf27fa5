# SPDX-License-Identifier: GPL-3.0-or-later
"""The body measures: names, groups, ranges.

They are read from ``data/measures.json``, which ``cargo xtask package blender`` writes from the model, so that Blender starts
without loading the model."""

import json
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

GROUPS = ("Head", "Torso", "Arms", "Legs")
_GROUP_OF_FIRST_WORD = {
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
    """A body measure. Lengths in metres; ``low`` and ``high`` are the limits that the model states."""

    name: str
    kind: str
    standard: str
    low: float
    high: float

    @property
    def label(self):
        """The name for the user interface, without the side."""
        words = self.name.removesuffix("_left").removesuffix("_right").split("_")
        return " ".join(word if word == "to" else word.capitalize() for word in words)

    @property
    def side(self):
        """``left``, ``right``, or empty."""
        return self.name.rpartition("_")[2] if self.name.endswith(("_left", "_right")) else ""

    @property
    def group(self):
        """The part of the body, one of ``GROUPS``."""
        return _GROUP_OF_FIRST_WORD.get(self.name.partition("_")[0], "Torso")

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
        """The tooltip."""
        methods = {
            "tape": "Circumference as a tape measures it",
            "slice": "Circumference at one height, as a tape measures it",
        }
        text = methods.get(self.kind, "Distance between two points")
        if self.standard:
            text += f". Closest standard: {self.standard}"
        return text + f". Range: {self.low:.3f} to {self.high:.3f} m"


@lru_cache(maxsize=1)
def all_measures():
    """All measures, in the order of the library."""
    text = (Path(__file__).parent / "data" / "measures.json").read_text(encoding="utf-8")
    return tuple(
        Measure(entry["name"], entry["kind"], entry.get("standard") or "", entry["min"], entry["max"])
        for entry in json.loads(text)["measures"]
    )


def names():
    """The names of all measures."""
    return tuple(measure.name for measure in all_measures())
