#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write channel.poly: a NACA 0012 section with its wake line above a heated plate in a channel, all by formula."""
import math


def naca0012(n):
    """n points a side from the trailing edge over the nose and back, the trailing edge sharp (last coefficient -0.1036)."""
    def half_thickness(x):
        return 0.6 * (0.2969 * math.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)

    upper = [0.5 * (1 + math.cos(math.pi * i / n)) for i in range(n + 1)]
    loop = [(x, half_thickness(x)) for x in upper] + [(x, -half_thickness(x)) for x in reversed(upper)]
    return [p for i, p in enumerate(loop[:-1]) if i == 0 or p != loop[i - 1]]


def main():
    points, segments = [], []

    def add(chain, marker, is_closed):
        first = len(points)
        points.extend(chain)
        count = len(chain) if is_closed else len(chain) - 1
        segments.extend((first + i, first + (i + 1) % len(chain), marker) for i in range(count))
        return first

    add([(-2, -1), (4, -1), (4, 1), (-2, 1)], 1, True)
    body = add(naca0012(40), 2, True)
    add([(0, -0.8), (1, -0.8), (1, -0.7), (0, -0.7)], 3, True)
    wake = add([(1.5, 0), (2, 0)], 4, False)
    segments.append((body, wake, 4))
    with open("channel.poly", "w", encoding="ascii") as file:
        file.write(f"{len(points)} 2 0 0\n")
        file.writelines(f"{i} {x!r} {y!r}\n" for i, (x, y) in enumerate(points))
        file.write(f"{len(segments)} 1\n")
        file.writelines(f"{i} {a} {b} {marker}\n" for i, (a, b, marker) in enumerate(segments))
        file.write("1\n0 0.5 0\n")  # the section is a hole
        file.write("2\n0 -1.9 -0.9 1 -1\n1 0.5 -0.75 2 0.0002\n")  # the fluid; the plate, with a largest area


if __name__ == "__main__":
    main()
