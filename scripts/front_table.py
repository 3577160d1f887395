#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Grid every valid surface of the shared geometry by the pure front, check each grid, and write the table of it.

    front_table.py --delfront build/release/delfront [--only PATTERN] [--out docs/front-corpus.md] [--timeout 600]

Each surface is gridded as `mesh FILE --set volume.method=front`; each grid is checked by check_mesh.py, which shares no
code with delfront. Cavities: what the sweeps left, filled round one point in each; by Delaunay: those of them that were
closed by constrained Delaunay, with their share of all tetrahedra (at most 0.1 %). Exit 1 where a run or a grid is not
as it should be.
"""
import sys
import tempfile

from corpus_table import Run, read_options, read_rows, write_page

MOST_BY_DELAUNAY = 1e-3
HEAD = """<!-- made by scripts/front_table.py -->
# The pure front on the shared geometry

`mesh FILE --set volume.method=front`, checked by `check_mesh.py GRID --surface FILE --keep-surface`. Sweeps that were
needed; cavities that they left, filled round one point each after so many tetrahedra round them were emptied; those
that no point sees whole, filled by stars of several; those that constrained Delaunay had to close, and the share of the
tetrahedra in them (at most 0.1 % is asked for). Angles are the smallest dihedral angle after improvement, and the mean
of the smallest of each cell.

| file | tetrahedra | sweeps | cavities | emptied | by stars | by Delaunay | share | least angle | mean | crossing tests | seconds | checker |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |
"""


def line_of(row, run):
    if run.exit != 0:
        return f"| {row['path']} | | | | | | | | | | | | {'; '.join(run.problems)} |"
    front = run.get("front")
    if front.get("gave_up"):
        run.problems.append("no front: " + front["gave_up"])
    tets = run.get("quality", "num_cells")
    share = front["closed_by_delaunay"] / max(tets, 1)
    if share > MOST_BY_DELAUNAY:
        run.problems.append(f"{share:.2%} of the tetrahedra by Delaunay")
    least, mean = (run.get("quality", "measures", "min_dihedral", k) for k in ("min", "mean"))
    verdict = "; ".join(run.problems) or run.verdict
    return (f"| {row['path']} | {tets:,} | {front['sweeps']} | {front['cavities']} | {front['cells_emptied']} | "
            f"{front['cavities_by_stars']} | {front['cavities_left']} | {share:.3%} | {least:.1f} | {mean:.1f} | {front['crossing_share']:.0%} | "
            f"{run.seconds:.1f} | {verdict} |")


def main():
    options = read_options(__doc__, "front-corpus.md")
    rows = [row for row in read_rows(options) if row["valid"]]
    lines, bad = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for row in rows:
            run = Run(row, ["--set", "volume.method=front"], options, folder)
            lines.append(line_of(row, run))
            print(lines[-1], flush=True)
            bad += bool(run.problems)
    write_page(options, HEAD + "\n".join(lines) + f"\n\n{len(rows) - bad} of {len(rows)} as they should be.\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
