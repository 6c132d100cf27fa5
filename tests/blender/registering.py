"""Registration, and descriptions of operators and properties."""

import zipfile

import bpy

from blender import import_order
from blender.harness import NAME, archive, check, clean, module

_MENUS = ("VIEW3D_MT_mesh_add", "TOPBAR_MT_file_import", "TOPBAR_MT_file_export")


def _known():
    """What the extension registers: types, operators, properties, menu entries; and all handlers."""
    handlers = {
        name: len(getattr(bpy.app.handlers, name))
        for name in dir(bpy.app.handlers)
        if isinstance(getattr(bpy.app.handlers, name), list)
    }
    return (
        {name for name in dir(bpy.types) if "anthro" in name.lower()},
        set(dir(bpy.ops.anthronet)),
        {name for cls in (bpy.types.Object, bpy.types.Scene) for name in dir(cls) if "anthro" in name.lower()},
        [len(getattr(bpy.types, menu).draw._draw_funcs) for menu in _MENUS],
        handlers,
    )


def importing():
    """The imports of the modules that are in the zip."""
    missed = import_order.missed()
    check("the check of imports finds what is planted", not missed, "; ".join(missed))
    with zipfile.ZipFile(archive) as files:
        sources = {name: files.read(name).decode() for name in files.namelist() if name.endswith(".py")}
    faults = import_order.faults(sources)
    check("imports have no cycle and go one way", len(sources) > 20 and not faults, "; ".join(faults))


def registering():
    clean()
    first = _known()
    for _ in range(20):
        bpy.ops.preferences.addon_disable(module=NAME)
        bpy.ops.preferences.addon_enable(module=NAME)
    check("disabling and enabling 20 times leaves nothing behind", _known() == first)
    bpy.ops.preferences.addon_disable(module=NAME)
    types, operators, properties, _, handlers = _known()
    check(
        "a disabled extension has no types, operators and properties",
        not types and not operators and not properties,
        f"{types} {operators} {properties}",
    )
    check("the extension has no handlers", handlers == first[4])
    bpy.ops.preferences.addon_enable(module=NAME)
    describing()


def describing():
    operators = [getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ANTHRONET_OT_")]
    reads = {"anthronet.request_save", "anthronet.character_export", "anthronet.preset_add"}
    faults, silent = [], []
    for operator in operators:
        family, _, name = operator.bl_idname.partition(".")
        rna = getattr(getattr(bpy.ops, family), name).get_rna_type()
        if not rna.description or "\n" in rna.description or rna.description.endswith("."):
            # Blender does not join lines and adds the full stop itself.
            faults.append(f"{operator.bl_idname}: its description is not one line without a full stop")
        if "poll" not in {key for cls in operator.__mro__ for key in vars(cls)}:
            faults.append(f"{operator.bl_idname}: no poll")
        if operator.bl_idname not in reads and "UNDO" not in getattr(operator, "bl_options", ()):
            faults.append(f"{operator.bl_idname}: no undo")
        own = {key for cls in operator.__mro__ for key in getattr(cls, "__annotations__", {})}
        silent += _silent(operator.bl_idname, rna, own)
    check("every operator has a poll, a description and undo", len(operators) >= 17 and not faults, "; ".join(faults))
    properties = module("state.properties")
    for group in (properties.AnthroCharacter, properties.AnthroMeasureReport):
        silent += _silent(group.__name__, group.bl_rna, set(group.bl_rna.properties.keys()) - {"name", "rna_type"})
    silent += _silent("Scene", bpy.types.Scene.bl_rna, {"anthronet_edit_together"})
    check("every property and enum item has a tooltip", not silent, "; ".join(silent))


def _silent(owner, rna, names):
    """Properties and enum items without a description."""
    for one in rna.properties:
        # Properties of Blender's mix-ins for presets and files.
        if one.identifier not in names or one.identifier in ("name", "remove_name", "remove_active"):
            continue
        if not one.description or not one.name:
            yield f"{owner}.{one.identifier}"
        if one.type == "ENUM":
            yield from (f"{owner}.{one.identifier}.{it.identifier}" for it in one.enum_items if not it.description)
