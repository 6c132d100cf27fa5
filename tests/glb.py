"""A small reader of binary glTF, written for the tests alone: it shares nothing with the library that it checks.

Arrays are numpy, lengths metres, matrices for column vectors, as in the file.
"""

import json
import struct
from pathlib import Path

import numpy as np

COMPONENTS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Glb:
    def __init__(self, path):
        data = Path(path).read_bytes()
        magic, version, length = struct.unpack_from("<4sII", data)
        if magic != b"glTF" or version != 2 or length != len(data):
            raise ValueError(f"{path}: not a whole binary glTF 2 file")
        size, kind = struct.unpack_from("<I4s", data, 12)
        if kind != b"JSON":
            raise ValueError(f"{path}: the first chunk is {kind}, not JSON")
        self.json = json.loads(data[20 : 20 + size])
        size, kind = struct.unpack_from("<I4s", data, 20 + size)
        if kind != b"BIN\0":
            raise ValueError(f"{path}: the second chunk is {kind}, not BIN")
        self.bytes = data[-size:]
        self.nodes = self.json["nodes"]
        self.parent = {child: i for i, node in enumerate(self.nodes) for child in node.get("children", [])}

    def accessor(self, index):
        """(count,) or (count, width), floating where the file says normalised."""
        accessor = self.json["accessors"][index]
        if "sparse" in accessor:
            raise ValueError(f"accessor {index} is sparse, which this reader does not know")
        view = self.json["bufferViews"][accessor["bufferView"]]
        dtype = np.dtype(COMPONENTS[accessor["componentType"]]).newbyteorder("<")
        width, count = WIDTHS[accessor["type"]], accessor["count"]
        stride = view.get("byteStride", dtype.itemsize * width)
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        array = np.ndarray((count, width), dtype, self.bytes, start, (stride, dtype.itemsize)).copy()
        if accessor.get("normalized"):
            array = array.astype(np.float64) / np.iinfo(dtype).max
        return array[:, 0] if width == 1 else array

    def skinned_nodes(self):
        """Node indices, in order; the first one is the body."""
        return [i for i, node in enumerate(self.nodes) if "skin" in node and "mesh" in node]

    def primitives(self, node):
        return self.json["meshes"][self.nodes[node]["mesh"]]["primitives"]

    def positions(self, primitive):
        return self.accessor(primitive["attributes"]["POSITION"]).astype(np.float64)

    def triangles(self, primitive):
        return self.accessor(primitive["indices"]).astype(np.int64).reshape(-1, 3)

    def influences(self, primitive):
        """Joint slots and weights of all sets, both (count, 4 × sets)."""
        attributes, slots, weights = primitive["attributes"], [], []
        while f"JOINTS_{len(slots)}" in attributes:
            i = len(slots)
            slots.append(self.accessor(attributes[f"JOINTS_{i}"]).astype(np.int64))
            weights.append(self.accessor(attributes[f"WEIGHTS_{i}"]).astype(np.float64))
        return np.hstack(slots), np.hstack(weights)

    def skin(self, node):
        """Node indices of the joints, and their inverse bind matrices (joints, 4, 4)."""
        skin = self.json["skins"][self.nodes[node]["skin"]]
        matrices = self.accessor(skin["inverseBindMatrices"]).astype(np.float64)
        # Stored column by column.
        return skin["joints"], matrices.reshape(-1, 4, 4).transpose(0, 2, 1)

    def skinned(self, node, world, least=0.0):
        """Positions of a node's primitives one after the other (vertices, 3): linear blend skinning in double precision.

        `world` are the matrices of all nodes. Weights below `least` are left out.
        """
        joints, joint_from_bind = self.skin(node)
        matrices, parts = world[joints] @ joint_from_bind, []
        for primitive in self.primitives(node):
            slots, weights = self.influences(primitive)
            if least > 0:
                weights = np.where(weights < least, 0, weights)
                weights /= weights.sum(1, keepdims=True)
            points = np.c_[self.positions(primitive), np.ones(len(slots))]
            parts.append(np.einsum("vk,vkij,vj->vi", weights, matrices[slots], points)[:, :3])
        return np.vstack(parts)

    def animated(self, animation, time):
        """{node: {path: value}} of an animation at a time, seconds: linear, spherical for rotations."""
        values = {}
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            if sampler.get("interpolation", "LINEAR") != "LINEAR":
                raise ValueError(f"interpolation {sampler['interpolation']}, which this reader does not know")
            times = self.accessor(sampler["input"]).astype(np.float64)
            keys = self.accessor(sampler["output"]).astype(np.float64)
            after = int(np.searchsorted(times, time))
            if after == 0 or after == len(times):
                value = keys[min(after, len(times) - 1)]
            else:
                t = (time - times[after - 1]) / (times[after] - times[after - 1])
                blend = slerp if channel["target"]["path"] == "rotation" else lambda a, b, t: a + (b - a) * t
                value = blend(keys[after - 1], keys[after], t)
            values.setdefault(channel["target"]["node"], {})[channel["target"]["path"]] = value
        return values

    def world(self, rotations=None, animated=None):
        """World matrices of all nodes (nodes, 4, 4), each local rotation followed by the one given for its name.

        What `animated` has of a node stands in the place of the node's own.
        """
        rotations, animated = rotations or {}, animated or {}
        done = {}

        def matrix(i):
            if i not in done:
                node = {**self.nodes[i], **animated.get(i, {})}
                if "matrix" in node:
                    local = np.array(node["matrix"], float).reshape(4, 4).T
                else:
                    local = np.eye(4)
                    local[:3, 3] = node.get("translation", (0, 0, 0))
                    scale = np.diag(node.get("scale", (1, 1, 1)))
                    local[:3, :3] = rotation(node.get("rotation", (0, 0, 0, 1))) @ scale
                local[:3, :3] = local[:3, :3] @ rotation(rotations.get(node.get("name"), (0, 0, 0, 1)))
                done[i] = (matrix(self.parent[i]) if i in self.parent else np.eye(4)) @ local
            return done[i]

        return np.array([matrix(i) for i in range(len(self.nodes))])


def rotation(quaternion):
    """Matrix of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def slerp(a, b, t):
    """Between unit quaternions, the short way."""
    cosine = float(a @ b)
    b, cosine = (-b, -cosine) if cosine < 0 else (b, cosine)
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-9:
        return a + (b - a) * t
    return (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / np.sin(angle)


class Cases:
    """Prints cases in the form that the runner counts."""

    def __init__(self):
        self.failed = 0

    def case(self, name, good, why=""):
        if good:
            print(f"ok {name}", flush=True)
        else:
            self.failed += 1
            print(f"FAILED {name}: {why}", flush=True)

    def close_to(self, name, got, expected, tolerance):
        """Largest difference of two arrays against a tolerance in metres."""
        got, expected = np.asarray(got), np.asarray(expected)
        if got.shape != expected.shape:
            self.case(name, False, f"shape {got.shape}, expected {expected.shape}")
            return
        worst = float(np.abs(got - expected).max()) if got.size else 0.0
        good = worst <= tolerance
        self.case(f"{name} (largest difference {worst * 1000:.6f} mm)" if good else name, good,
                  f"largest difference {worst * 1000:.6f} mm, at most {tolerance * 1000} mm expected")

    def exit(self):
        raise SystemExit(1 if self.failed else 0)
