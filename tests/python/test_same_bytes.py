"""The same bytes from the Python package as from Rust, C and C++: the list that ffi/tests/same_bytes.rs leaves."""

import hashlib

import anthronet


def line(number, request):
    try:
        body = anthronet.default_model().generate(anthronet.Request.from_json(request))
        clips = [anthronet.builtin_clip("walk", body)] if number % 10 == 3 else []
        return hashlib.sha256(body.to_bytes("glb", lod=number % 4, clips=clips)).hexdigest()
    except anthronet.Error as error:
        return f"error {error.code}"


def test_same_bytes(same_bytes):
    """Same bytes: 200 requests through Python"""
    requests = (same_bytes / "requests.jsonl").read_text("utf-8").splitlines()
    expected = (same_bytes / "sha256.txt").read_text("utf-8").splitlines()
    assert len(requests) == len(expected) >= 200, f"{len(requests)} requests, {len(expected)} hashes"
    differ = [i for i, request in enumerate(requests) if line(i, request) != expected[i]]
    assert not differ, f"requests {differ[:10]} of {len(requests)} differ"
