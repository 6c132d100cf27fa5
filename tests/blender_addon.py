"""The Blender extension as its users have it: installed from its zip, then used.

    python blender_addon.py anthronet-….zip PICTURES [PART…]

Runs in any Blender from 4.2 as a module. Speeds are printed beside their bars and never fail.
"""

import os
import sys
import time
import traceback

from blender.harness import cases, check  # Comes before anything that imports Blender.

import bpy

from blender.creating import creating, crowding, installing, unitising
from blender.editing import carrying, editing, escaping, posing_together, sculpting, ticking, tinting, together
from blender.exchanging import exporting
from blender.guarding import failing, failing_whole, linking, refusing, sharing
from blender.keeping import adjusting, keeping, undoing
from blender.moving import following, layering, moving, rating, refitting, rigging, slicing
from blender.picturing import picturing
from blender.registering import importing, registering

PARTS = (
    installing,
    importing,
    creating,
    unitising,
    editing,
    posing_together,
    escaping,
    ticking,
    sculpting,
    carrying,
    together,
    tinting,
    refusing,
    failing_whole,
    failing,
    sharing,
    linking,
    moving,
    rating,
    layering,
    refitting,
    following,
    rigging,
    slicing,
    exporting,
    undoing,
    adjusting,
    keeping,
    crowding,
    registering,
    picturing,
)

if __name__ == "__main__":
    wanted = set(sys.argv[3:])
    print(f"Blender {bpy.app.version_string}")
    for part in PARTS:
        if wanted and part is not installing and part.__name__ not in wanted:
            continue
        start = time.perf_counter()
        try:
            part()
        except Exception as error:  # A part that breaks off is a failed case; the others are still worth running.
            traceback.print_exc()
            check(f"{part.__name__} runs to its end", False, f"{type(error).__name__}: {error}")
        print(f"{part.__name__}: {time.perf_counter() - start:.1f} s")
    # Blender 4.5 as a module may wait for a thread of its own when it ends.
    sys.stdout.flush()
    os._exit(1 if cases.failed else 0)
