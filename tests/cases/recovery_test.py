#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Boundaries that resist: what is done instead, and said, in bounded time."""
import math
import unittest

import case


def rod(turn, radius=0.002, length=0.6, start=0.15):
    """A hexagonal prism along a ray from the origin, turned about y, with two triangles a side."""
    def place(x, y, z):
        return (x * math.cos(turn) + z * math.sin(turn), y, z * math.cos(turn) - x * math.sin(turn))

    rings = [[place(radius * math.cos(i * math.pi / 3), radius * math.sin(i * math.pi / 3), z) for i in range(6)]
             for z in (start, start + length)]
    ends = [place(0, 0, start), place(0, 0, start + length)]
    triangles = []
    for i in range(6):
        (a, b), (c, d) = ((ring[i], ring[(i + 1) % 6]) for ring in rings)
        triangles += [(a, b, d), (a, d, c), (ends[0], b, a), (ends[1], c, d)]
    return triangles


class NewSurfaces(case.Case):
    def test_slender_rods_give_way_to_the_given_triangles(self):
        """Edges of the new surface need ever more points; this took minutes, without a word."""
        self.write("ball.stl", case.stl_ascii(case.sphere_triangles(2)))
        names = ["ball.stl"]
        for i in range(3):
            names.append(self.write(f"rod{i}.stl", case.stl_ascii(rod(i * math.pi / 6))))
        self.expect(6, "mesh", *names, "-o", "g.vtu", "--surface-method", "front", "--keep", "all", "--hmax", 0.2,
                    "--max-cells", 20000,
                    says=["the given triangles are kept", "edges are still missing", "the first near", "smaller sizes there",
                          "stopped before gridding"])


if __name__ == "__main__":
    unittest.main()
