#!/usr/bin/env python3
"""Makes assets/scans/creature.ply: a long-necked animal as a scanner would give it (needs numpy).

usage: python3 assets/make_scan.py      (takes a minute or two)

The body is the smooth union of round cones; no mesh is made. Points are thrown near the surface,
dropped onto it along the gradient, thinned by dart throwing to an even spacing, and
moved along the normal by a measurement error of a twentieth of the spacing. Millimetres, y up, feet
on y = 0. No normals: a reader has to estimate them, as for most scans.
"""
import pathlib

import numpy as np

COUNT = 30000
SEED = 7
BLEND = 7.0  # mm over which parts melt into each other
FILE = pathlib.Path(__file__).resolve().parent / "scans" / "creature.ply"


def round_cone(p, a, b, ra, rb):
    """Distance (a good lower bound) to a cone between two balls."""
    a, b = np.array(a, float), np.array(b, float)
    t = ((p - a) @ (b - a) / ((b - a) @ (b - a))).clip(0, 1)
    return np.linalg.norm(p - a - t[:, None] * (b - a), axis=1) - (ra + (rb - ra) * t)


def parts():
    """Chains of (centre, radius): spine from nose to tail, four legs, two horns, plates."""
    yield [((118, 139, 0), 6), ((104, 143, 0), 11), ((90, 146, 0), 12.5)]  # head
    yield [((92, 146, 0), 10.5), ((82, 128, 0), 9.5), ((68, 106, 0), 12), ((48, 86, 0), 20)]  # neck
    yield [((46, 80, 0), 27), ((8, 75, 0), 33), ((-30, 76, 0), 27)]  # trunk
    yield [((-34, 78, 0), 22), ((-66, 72, 3), 14), ((-96, 60, 12), 9), ((-118, 53, 27), 6),
           ((-128, 57, 44), 4), ((-124, 66, 56), 3)]  # tail
    for side in (-1, 1):
        yield [((44, 66, 17 * side), 15), ((50, 36, 22 * side), 10.5), ((49, 9, 22 * side), 9),
               ((55, 7, 23 * side), 8)]  # fore leg
        yield [((-28, 66, 18 * side), 18), ((-36, 38, 23 * side), 11.5), ((-32, 9, 23 * side), 9.5),
               ((-25, 7, 24 * side), 8.5)]  # hind leg
        yield [((90, 154, 6 * side), 4.2), ((84, 168, 11 * side), 2.6)]  # horn
    for i in range(9):  # plates along the back
        x = 52 - 13 * i
        y = 76 + 30 * np.cos((x - 8) / 62) + (1.5 if i in (3, 4, 5) else 0)
        yield [((x, y - 6, 0), 4.5), ((x - 5, y + 8 - abs(i - 4), 0), 2.8)]


def distance(p):
    """Smooth union of all parts: -BLEND/k log sum exp, the same for any order of the parts."""
    sharpness = 3 / BLEND
    total = np.zeros(len(p))
    for chain in parts():
        limb = np.min([round_cone(p, a, b, ra, rb)
                       for (a, ra), (b, rb) in zip(chain[:-1], chain[1:])], axis=0)
        total += np.exp(-sharpness * np.maximum(limb, -60))
    ripple = 0.5 * np.sin(p[:, 0] / 5.1) * np.sin(p[:, 1] / 4.7) * np.sin(p[:, 2] / 5.3)  # skin folds
    return -np.log(np.maximum(total, 1e-300)) / sharpness + ripple


def gradient(p, h=0.05):
    return np.stack([distance(p + h * e) - distance(p - h * e) for e in np.eye(3)], axis=1) / (2 * h)


def project(p):
    for _ in range(4):
        g = gradient(p)
        p = p - (distance(p) / np.maximum((g * g).sum(axis=1), 1e-3))[:, None] * g
    return p[np.abs(distance(p)) < 1e-3]


def thrown(rng, count, cell=4.0, shell=0.8):
    """Points spread over the surface evenly by area: uniform in a thin shell, then dropped onto it."""
    axes = [np.arange(low, high, cell) for low, high in ((-144, 136), (-8, 182), (-48, 70))]
    corners = np.stack(np.meshgrid(*axes, indexing="ij"), axis=3).reshape(-1, 3)
    corners = corners[np.abs(distance(corners + cell / 2)) < 1.5 * cell]
    kept, found = [], 0
    while found < count:
        p = corners[rng.integers(len(corners), size=100000)] + cell * rng.random((100000, 3))
        p = p[np.abs(distance(p)) < 2 * shell]
        thin = np.abs(distance(p)) < shell * np.linalg.norm(gradient(p), axis=1)
        kept.append(project(p[thin]))
        found += len(kept[-1])
    return np.concatenate(kept)[:count]


def darts(points, spacing):
    """Indices of the points, in their order, that are at least `spacing` from all kept before."""
    cells, kept = {}, []
    keys = np.floor(points / spacing).astype(int)
    around = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    limit = spacing * spacing
    for index, ((x, y, z), (i, j, k)) in enumerate(zip(points.tolist(), keys.tolist())):
        free = True
        for di, dj, dk in around:
            for qx, qy, qz in cells.get((i + di, j + dj, k + dk), ()):
                if (x - qx) ** 2 + (y - qy) ** 2 + (z - qz) ** 2 < limit:
                    free = False
                    break
            if not free:
                break
        if free:
            cells.setdefault((i, j, k), []).append((x, y, z))
            kept.append(index)
    return np.array(kept)


def main():
    rng = np.random.Generator(np.random.PCG64(SEED))
    candidates = thrown(rng, 8 * COUNT)
    low, high = 0.8, 2.0  # mm: the spacing that leaves COUNT points lies between
    for _ in range(8):
        spacing = (low + high) / 2
        kept = darts(candidates, spacing)
        low, high = (spacing, high) if len(kept) > COUNT else (low, spacing)
    points = candidates[kept]
    g = gradient(points)
    normals = g / np.linalg.norm(g, axis=1, keepdims=True)
    points = points + normals * rng.normal(0, 0.05 * spacing, (len(points), 1))
    points = points[np.lexsort(np.floor(points / 8).T)]  # neighbours close in the file, as scanners write
    points -= (0, points[:, 1].min(), 0)
    header = (f"ply\nformat binary_little_endian 1.0\ncomment made by assets/make_scan.py, CC0-1.0\n"
              f"comment unit mm\nelement vertex {len(points)}\n"
              "property float x\nproperty float y\nproperty float z\nend_header\n")
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_bytes(header.encode() + points.astype("<f4").tobytes())
    print(f"{FILE.name}: {len(points)} points, spacing {spacing:.2f} mm, {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
