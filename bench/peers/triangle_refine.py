# SPDX-License-Identifier: Apache-2.0
"""Times Shewchuk's Triangle, as PyPI's `triangle` wraps it, on loops of segments.

    triangle_refine.py CASE.json SWITCHES

CASE.json: {"loops": [[[x, y], ...], ...], "hole": [x, y] or null, "split": length or null}: the first loop is cut into
pieces of that length. Prints one line of JSON; "seconds" is the call, with the wrapper's copies of the result.
"""

import json
import math
import sys
import time

import numpy as np
import triangle


def split_loop(loop: list, length: float) -> list:
    points = []
    for (x, y), (u, v) in zip(loop, loop[1:] + loop[:1]):
        pieces = max(1, math.ceil(math.hypot(u - x, v - y) / length))
        points += [[x + (u - x) * i / pieces, y + (v - y) * i / pieces] for i in range(pieces)]
    return points


def smallest_angle(points: np.ndarray, triangles: np.ndarray) -> float:
    p = points[triangles]
    to_next, to_last = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
    lengths = np.linalg.norm(to_next, axis=2) * np.linalg.norm(to_last, axis=2)
    return float(np.degrees(np.arccos(np.clip((to_next * to_last).sum(axis=2) / lengths, -1, 1))).min())


def main() -> int:
    with open(sys.argv[1]) as file:
        case = json.load(file)
    if case["split"]:
        case["loops"][0] = split_loop(case["loops"][0], case["split"])
    points, segments = [], []
    for loop in case["loops"]:
        n = len(points)
        segments += [[n + i, n + (i + 1) % len(loop)] for i in range(len(loop))]
        points += loop
    domain = {"vertices": np.array(points, float), "segments": np.array(segments)}
    if case["hole"]:
        domain["holes"] = np.array([case["hole"]], float)
    start = time.perf_counter()
    grid = triangle.triangulate(domain, sys.argv[2])
    seconds = time.perf_counter() - start
    corner = grid["vertices"][grid["triangles"]]
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    facts = {
        "seconds": seconds,
        "triangles": len(corner),
        "area": float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2),
    }
    sides = np.roll(corner, -1, axis=1) - corner
    areas = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    facts["mean_quality"] = float((4 * 3**0.5 * areas / (sides**2).sum(axis=(1, 2))).mean())
    facts["min_angle"] = smallest_angle(grid["vertices"], grid["triangles"])
    print(json.dumps(facts))
    return 0


if __name__ == "__main__":
    sys.exit(main())
