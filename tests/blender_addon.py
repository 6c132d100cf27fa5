"""Tests of the Blender extension, installed from its zip.

    python blender_addon.py anthronet-….zip PICTURES [PART…]

Runs in Blender 4.2 and newer as a Python module. Times are printed with their limits and never fail.
"""

import os
import sys
import time
import traceback

from blender.harness import cases, check  # Comes before anything that imports Blender.

import bpy

from blender.creating import creating, crowding, installing, unitising
from blender.editing import editing, escaping, posing_together, sculpting, ticking, tinting, together, transferring
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
    transferring,
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
        except Exception as error:  # An error in one part must not keep the others from running.
            traceback.print_exc()
            check(f"{part.__name__} ends without an error", False, f"{type(error).__name__}: {error}")
        print(f"{part.__name__}: {time.perf_counter() - start:.1f} s")
    # Blender 4.5 as a module may hang at exit, waiting for one of its threads.
    sys.stdout.flush()
    os._exit(1 if cases.failed else 0)
