"""The Unity package as Unity's package manager wants it: .meta files, versions, assembly definitions.

    python unity_package.py [ARCHIVE]   checks, the packed package too where it is named
    python unity_package.py --write     writes the .meta files that are missing

A guid is derived from the path of its file, and of a renamed file from its first path: it is the same on every machine and
never changes.
"""

import hashlib
import json
import re
import sys
import tarfile
from pathlib import Path

import unity_population

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "unity_plugin"
NAME = "com.anthronet.unity"
#: Assemblies of Unity's own packages; those that a project does not have are left out of a reference by Unity.
FOREIGN = {"Unity.Burst", "UnityEngine.TestRunner", "UnityEditor.TestRunner"}
#: Where the native library of this system lies in a package.
LIBRARY = {"linux": "Linux/x86_64/libanthronet.so", "darwin": "macOS/libanthronet.dylib", "win32": "Windows/x86_64/anthronet.dll"}


#: Renamed files, whose guids come from their first paths: scenes and prefabs refer to scripts by guid.
RENAMED = {"Runtime/AnthroPoseDrivenShapes.cs": "Runtime/AnthroCorrectives.cs"}


def guid(path):
    first = RENAMED.get(path.as_posix(), path.as_posix())
    return hashlib.md5(f"{NAME}/{first}".encode()).hexdigest()


def assets():
    """What Unity imports, relative to the package: not what begins with a dot or ends in a tilde, .meta files neither.

    Samples are copied into a project out of `Samples~` and imported there, with their .meta files.
    """
    for path in sorted(PACKAGE.rglob("*")):
        relative = path.relative_to(PACKAGE)
        parts = relative.parts[1:] if relative.parts[0] == "Samples~" else relative.parts
        hidden = not parts or any(part.startswith(".") or part.endswith("~") for part in parts)
        if not hidden and path.suffix != ".meta" and path.suffix not in (".so", ".dll", ".dylib", ".a"):
            yield relative


def plugins():
    """Libraries that packaging puts there: their paths, with their settings."""
    table = json.loads((PACKAGE / "Plugins~/platforms.json").read_text("utf-8"))
    for entry in table["plugins"]:
        yield Path("Runtime/Plugins") / entry["file"], entry


def meta(relative):
    head = f"fileFormatVersion: 2\nguid: {guid(relative)}\n"
    tail = "  externalObjects: {}\n  userData: \n  assetBundleName: \n  assetBundleVariant: \n"
    if (PACKAGE / relative).is_dir():
        return f"{head}folderAsset: yes\nDefaultImporter:\n{tail}"
    if relative.suffix == ".cs":
        return (
            f"{head}MonoImporter:\n  externalObjects: {{}}\n  serializedVersion: 2\n  defaultReferences: []\n"
            "  executionOrder: 0\n  icon: {instanceID: 0}\n  userData: \n  assetBundleName: \n  assetBundleVariant: \n"
        )
    importer = {".asmdef": "AssemblyDefinitionImporter", ".md": "TextScriptImporter", ".json": "TextScriptImporter", ".txt": "TextScriptImporter"}
    kind = "PackageManifestImporter" if relative.name == "package.json" else importer[relative.suffix]
    return f"{head}{kind}:\n{tail}"


def plugin_meta(relative, entry):
    """Off everywhere but on its own platform."""

    def platform(key, enabled, settings):
        lines = f"  - first:\n      {key}\n    second:\n      enabled: {int(enabled)}\n"
        if not settings:
            return lines + "      settings: {}\n"
        return lines + "      settings:\n" + "".join(f"        {name}: {value}\n" for name, value in settings.items())

    text = (
        f"fileFormatVersion: 2\nguid: {guid(relative)}\nPluginImporter:\n  externalObjects: {{}}\n  serializedVersion: 2\n"
        "  iconMap: {}\n  executionOrder: {}\n  defineConstraints: []\n  isPreloaded: 0\n  isOverridable: 0\n"
        "  isExplicitlyReferenced: 0\n  validateReferences: 1\n  platformData:\n"
    )
    text += platform("Any: ", False, {})
    editor = entry.get("editor")
    settings = {"CPU": entry["cpu"], "DefaultValueInitialized": "true", "OS": editor} if editor else {}
    text += platform("Editor: Editor", bool(editor), settings)
    text += platform(entry["platform"], True, {"CPU": entry["cpu"]} if "cpu" in entry else {})
    return text + "  userData: \n  assetBundleName: \n  assetBundleVariant: \n"


def expected():
    """All .meta files of the repository with their text.

    Those of native libraries wait in `Plugins~`, where Unity does not look: one without its library would be deleted.
    """
    for relative in assets():
        yield meta_path(relative), meta(relative)
    for relative, entry in plugins():
        for folder in list(relative.parents)[:-3]:
            head = f"fileFormatVersion: 2\nguid: {guid(folder)}\n"
            tail = "  externalObjects: {}\n  userData: \n  assetBundleName: \n  assetBundleVariant: \n"
            yield waiting(folder), f"{head}folderAsset: yes\nDefaultImporter:\n{tail}"
        yield waiting(relative), plugin_meta(relative, entry)


def meta_path(relative):
    return PACKAGE / relative.with_name(relative.name + ".meta")


def waiting(relative):
    return meta_path(Path("Plugins~") / relative.relative_to("Runtime/Plugins"))


def test_metas():
    """every file has its .meta, no .meta is without its file"""
    wanted = dict(expected())
    wrong = [str(path) for path, text in wanted.items() if not path.is_file() or path.read_text("utf-8") != text]
    assert not wrong, f"missing or changed, `python tests/unity_package.py --write` writes them: {wrong}"
    there = {path for path in PACKAGE.rglob("*.meta")}
    assert there == set(wanted), f"without their file: {sorted(map(str, there - set(wanted)))}"


def test_guids():
    """guids are unique"""
    guids = [re.search("^guid: ([0-9a-f]{32})$", path.read_text("utf-8"), re.M).group(1) for path in PACKAGE.rglob("*.meta")]
    assert len(guids) > 30, f"only {len(guids)}"
    assert len(guids) == len(set(guids)), "twice the same"


def test_versions():
    """package.json, the code and the changelog have the version of the workspace"""
    cargo = re.search(r'\[workspace\.package\]\nversion = "([^"]+)"', (ROOT / "Cargo.toml").read_text("utf-8")).group(1)
    manifest = json.loads((PACKAGE / "package.json").read_text("utf-8"))
    code = re.search(r'Version = "([^"]+)"', (PACKAGE / "Runtime/AnthroPackage.cs").read_text("utf-8")).group(1)
    changes = re.search(r"^## \[([^\]]+)\]", (PACKAGE / "CHANGELOG.md").read_text("utf-8"), re.M).group(1)
    assert manifest["version"] == code == changes == cargo, (manifest["version"], code, changes, cargo)
    assert manifest["name"] == NAME and manifest["unity"] == "2021.3", manifest
    for sample in manifest["samples"]:
        assert any((PACKAGE / sample["path"]).glob("*.cs")), f"{sample['path']}: no script"


def test_assemblies():
    """every script belongs to an assembly definition, which names what there is"""
    definitions = {path: json.loads(path.read_text("utf-8")) for path in PACKAGE.rglob("*.asmdef")}
    names = {definition["name"] for definition in definitions.values()}
    assert len(names) == len(definitions), names
    for path, definition in definitions.items():
        assert path.stem == definition["name"], path
        unknown = [name for name in definition["references"] if name not in names | FOREIGN]
        assert not unknown, f"{path}: {unknown}"
        if "Tests" in path.parts:
            assert definition["defineConstraints"] == ["UNITY_INCLUDE_TESTS"], f"{path}: in players, too"
    scripts = list(PACKAGE.rglob("*.cs"))
    assert len(scripts) > 50, f"only {len(scripts)} scripts"
    for script in scripts:
        assert any(path.parent in script.parents for path in definitions), f"{script}: in no assembly"


def test_file_names():
    """components are in files of their names, which Unity needs"""
    for script in PACKAGE.rglob("*.cs"):
        for component in re.findall(r"class (\w+) : (?:MonoBehaviour|ScriptableObject)", script.read_text("utf-8")):
            assert component == script.stem, f"{component} is in {script.name}"


def test_namespaces():
    """scripts are in namespaces of ours, samples too"""
    for script in PACKAGE.rglob("*.cs"):
        text = script.read_text("utf-8")
        assert script.name == "AssemblyInfo.cs" or re.search(r"^namespace Anthronet(\.\w+)*$", text, re.M), script


def test_samples():
    """samples of package.json are there, each with its assembly, and every folder of samples is in it"""
    listed = {sample["path"]: sample for sample in json.loads((PACKAGE / "package.json").read_text("utf-8"))["samples"]}
    there = {f"Samples~/{path.name}" for path in (PACKAGE / "Samples~").iterdir() if path.is_dir()}
    assert set(listed) == there, f"{sorted(listed)} and {sorted(there)}"
    for path, sample in listed.items():
        assert sample["displayName"] and sample["description"], path
        assert len(list((PACKAGE / path).glob("*.asmdef"))) == 1, f"{path}: no assembly of its own"


def test_population():
    """the population is what its script makes"""
    made = "\n".join(unity_population.population()) + "\n"
    assert unity_population.FILE.read_text("utf-8") == made, "`python tests/unity_population.py --write` writes it"
    assert made.count("\n") == 200, made.count("\n")


def test_archive():
    """the packed package is these files, the native library of this system with its settings, and the licences"""
    wanted = {f"package/{path.relative_to(PACKAGE).as_posix()}" for path in PACKAGE.rglob("*") if path.is_file()}
    library = LIBRARY[sys.platform]
    wanted |= {f"package/Runtime/Plugins/{library}", f"package/Runtime/Plugins/{library}.meta"}
    wanted |= {f"package/Runtime/Plugins/{folder.as_posix()}.meta" for folder in list(Path(library).parents)[:-1]}
    wanted |= {f"package/Documentation~/{name}" for name in ("LICENSE-APACHE", "LICENSE-MIT", "THIRD_PARTY.md")}
    with tarfile.open(ARCHIVE) as archive:
        members = archive.getmembers()
    there = {member.name for member in members if member.isfile()}
    assert there == wanted, f"missing {sorted(wanted - there)}, left over {sorted(there - wanted)}"
    odd = [member.name for member in members if not (member.isfile() or member.isdir())]
    assert not odd, f"links: {odd}"
    assert next(member.size for member in members if member.name.endswith(library)) > 1 << 20, "the library is no library"


def main():
    global ARCHIVE
    if sys.argv[1:] == ["--write"]:
        for path, text in expected():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8", newline="\n")
        return 0
    failed = 0
    tests = [test_metas, test_guids, test_versions, test_assemblies, test_file_names, test_namespaces, test_samples, test_population]
    if len(sys.argv) > 1:
        ARCHIVE = sys.argv[1]
        tests.append(test_archive)
    for test in tests:
        try:
            test()
            print(f"ok Unity package: {test.__doc__}")
        except Exception as error:  # noqa: BLE001
            failed = 1
            print(f"FAILED Unity package: {test.__doc__}: {error}")
    return failed


sys.exit(main())
