# SPDX-License-Identifier: GPL-3.0-or-later
"""Quaternions x, y, z, w in numpy arrays, for many frames at once."""

import numpy as np


def from_matrices(rotations):
    """Unit quaternions of rotation matrices (…, 3, 3)."""
    m = rotations
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    squares = np.stack([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz], axis=-1)
    a, b, c = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    d, e, f = m[..., 1, 0] + m[..., 0, 1], m[..., 0, 2] + m[..., 2, 0], m[..., 2, 1] + m[..., 1, 2]
    # Four formulas, each proportional to the quaternion; the one with the largest component is the most precise.
    candidates = np.stack(
        [
            np.stack([squares[..., 0], d, e, a], axis=-1),
            np.stack([d, squares[..., 1], f, b], axis=-1),
            np.stack([e, f, squares[..., 2], c], axis=-1),
            np.stack([a, b, c, squares[..., 3]], axis=-1),
        ],
        axis=-2,
    )
    best = squares.argmax(axis=-1)[..., None, None]
    chosen = np.take_along_axis(candidates, best, axis=-2)[..., 0, :]
    return chosen / np.linalg.norm(chosen, axis=-1, keepdims=True)


def conjugate(q):
    """The inverse of unit quaternions (…, 4)."""
    return q * np.array([-1, -1, -1, 1])


def multiply(p, q):
    """The product of quaternions (n, 4): first the rotation ``q``, then ``p``."""
    px, py, pz, pw = p.T
    qx, qy, qz, qw = q.T
    return np.stack(
        [
            pw * qx + px * qw + py * qz - pz * qy,
            pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw,
            pw * qw - px * qx - py * qy - pz * qz,
        ],
        axis=1,
    )


def without_sign_flips(q):
    """The same rotations (frames, 4), signs chosen so that interpolation between frames takes the short way."""
    flips = np.sign(np.einsum("ij,ij->i", q[1:], q[:-1]))
    out = q.copy()
    out[1:] *= np.cumprod(np.where(flips < 0, -1.0, 1.0))[:, None]
    return out
