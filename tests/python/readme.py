"""The examples of the Python package's README."""

import re

from support import ROOT

README = ROOT / "python" / "README.md"


def examples():
    """The examples in their order: the line that each begins at, and its code."""
    text = README.read_text("utf-8")
    found = re.finditer(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [(text[: example.start()].count("\n") + 2, example[1]) for example in found]
