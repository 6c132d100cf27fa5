"""That nothing of the C interface was left out. The last file by name, which is the order in which pytest runs them."""

import gc
import re
from pathlib import Path

import pytest
from support import HEADER


def test_every_function_was_called(request, called):
    """every function of the header was called"""
    ran = {item.path for item in request.session.items}
    if not ran.issuperset(Path(__file__).parent.glob("test_*.py")):
        pytest.skip("only some of the tests of the interface were run")
    gc.collect()
    text = re.sub(r"//.*", "", HEADER.read_text("utf-8").split("*/", 1)[1])
    listed = set(re.findall(r"\b(anthronet_\w+)\s*\(", text))
    assert len(listed) > 80 and listed - {"anthronet_log_callback"} == called & listed, sorted(listed - called)
