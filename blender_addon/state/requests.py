# SPDX-License-Identifier: GPL-3.0-or-later
"""Requests to the library, and what of them fits into Blender's properties."""

import json

from .. import library
from . import definitions

#: Length of the identity vector, which the library calls ``z`` or latent.
IDENTITY_SIZE = 10


def from_fields(fields):
    """A request from the fields of its JSON form."""
    return library.anthronet().Request.from_json(json.dumps(fields))


def check_storable(request):
    """ValueError if a request contains a value that the properties cannot store."""
    if request.seed > definitions.LARGEST_SEED:
        raise ValueError(f"seed: expected at most {definitions.LARGEST_SEED} in Blender, got {request.seed}")
    if request.latent is not None and len(request.latent) != IDENTITY_SIZE:
        raise ValueError(f"z: expected {IDENTITY_SIZE} numbers, got {len(request.latent)}")
    shortest, longest = definitions.SHORTEST, definitions.LONGEST
    for name, value in request.measures.items():
        if not shortest <= value <= longest:
            raise ValueError(f"{name}: expected {shortest} to {longest} m in Blender, got {value:g} m")


def typed_decimal(number):
    """The decimal number that a user typed for a single-precision one: 1.7, not 1.7000000476837158."""
    return float(f"{number:.7g}")
