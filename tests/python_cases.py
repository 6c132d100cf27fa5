"""What the tests of the Python package share: functions `test_…` as cases, and errors that have to come."""

import sys
import traceback

from glb import Cases


def run(module):
    """Runs the functions `test_…` of a module, in order; the first line of each one's documentation is its name."""
    cases = Cases()
    for name, function in list(vars(module).items()):
        if not name.startswith("test_"):
            continue
        said = (function.__doc__ or name).splitlines()[0].rstrip(".")
        try:
            skipped = function()
        except Exception as error:
            frames = traceback.extract_tb(error.__traceback__)
            here = next((f for f in reversed(frames) if f.filename == module.__file__), frames[-1])
            cases.case(said, False, f"line {here.lineno}, `{here.line}`: {type(error).__name__}: {error}")
        else:
            if skipped:
                print(f"skipped {said}: {skipped}")
            else:
                cases.case(said, True)
    cases.exit()


def main_module():
    return sys.modules["__main__"]


def raises(kind, function, *words):
    """Calls a function that has to raise exactly this class, with all these words in its message."""
    try:
        function()
    except kind as error:
        assert type(error) is kind, f"{type(error).__name__} instead of {kind.__name__}: {error}"
        for word in words:
            assert word in str(error), f"`{error}` lacks `{word}`"
        return error
    raise AssertionError(f"nothing was raised, expected {kind.__name__}")
