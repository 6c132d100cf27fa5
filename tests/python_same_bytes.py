"""The same bytes from the Python package as from Rust, C and C++: the list that ffi/tests/same_bytes.rs leaves.

python python_same_bytes.py FOLDER
"""

import hashlib
import sys
from pathlib import Path

import anthronet
from python_cases import main_module, run

FOLDER = Path(sys.argv[1])


def line(number, request):
    try:
        body = anthronet.default_model().generate(anthronet.Request.from_json(request))
        clips = [anthronet.builtin_clip("walk", body)] if number % 10 == 3 else []
        return hashlib.sha256(body.to_bytes("glb", lod=number % 4, clips=clips)).hexdigest()
    except anthronet.Error as error:
        return f"error {error.code}"


def test_same_bytes():
    """Same bytes: 200 requests through Python"""
    requests = (FOLDER / "requests.jsonl").read_text("utf-8").splitlines()
    expected = (FOLDER / "sha256.txt").read_text("utf-8").splitlines()
    assert len(requests) == len(expected) >= 200, f"{len(requests)} requests, {len(expected)} hashes"
    differ = [i for i, request in enumerate(requests) if line(i, request) != expected[i]]
    assert not differ, f"requests {differ[:10]} of {len(requests)} differ"


run(main_module())
