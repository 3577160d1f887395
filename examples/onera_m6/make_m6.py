# SPDX-License-Identifier: Apache-2.0
"""Write the ONERA M6 wing as smooth geometry: splines through the published section, flat root and tip.

    make_m6.py OUT.geom.toml

Ordinates of the ONERA D section and planform: V. Schmitt, F. Charpin, Pressure distributions on the ONERA-M6-wing at
transonic Mach numbers, AGARD AR-138, 1979, as in NASA's NPARC validation archive (ONERA M6 wing). The tip is cut flat;
the wind tunnel's model has half a body of revolution there. x runs downstream, y along the span, z up; metres.
"""

import argparse
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "swept_wing"))
import make_wing  # noqa: E402

ORDINATES = """
0 0 .0000165 .0006914 .0000696 .0014416 .0001675 .0022554 .0003232 .0031382 .0005508 .0040959 .0008657 .0051343
.0012868 .0062598 .0018364 .0074784 .0025441 .0087958 .0034428 .0102163 .0045704 .0117419 .0059751 .0133708 .0077112
.0150951 .0098413 .0168984 .0124479 .0187537 .0156171 .0206220 .0194609 .0224545 .0241067 .0242004 .0297008 .0258245
.0364261 .0273317 .0444852 .0287912 .0541248 .0303278 .0656303 .0320138 .0793366 .0338372 .0956354 .0357742 .1149796
.0377923 .1378963 .0398522 .1649976 .0419089 .1919327 .0436214 .2187096 .0450507 .2453310 .0462358 .2717978 .0471987
.2981113 .0479494 .3242726 .0484902 .3502830 .0488183 .3761446 .0489296 .4018567 .0488202 .4274223 .0484833 .4528441
.0479351 .4781197 .0471661 .5032514 .0461903 .5282426 .0450209 .5530937 .0436741 .5778043 .0421684 .6023757 .0405241
.6268104 .0387613 .6511093 .0368990 .6752726 .0349542 .6993027 .0329402 .7231995 .0308662 .7469658 .0287365 .7705998
.0265505 .7941055 .0243027 .8174828 .0219842 .8407324 .0195838 .8638564 .0170915 .8868235 .0145051 .9061905 .0122389
.9225336 .0102727 .9363346 .0085827 .9479946 .0071423 .9578511 .0059224 .9661860 .0048907 .9732361 .0040180 .9792020
.0032796 .9842508 .0026547 .9885252 .0021257 .9921438 .0016778 .9952080 .0012985 .9978030 .0009773 1 .0007052
"""  # x z of the upper side over the chord, from the nose; the lower side is its mirror image


def section(chord, nose, y):
    """From the lower trailing edge round the nose to the upper one."""
    numbers = [float(word) for word in ORDINATES.split()]
    upper = list(zip(numbers[::2], numbers[1::2]))
    whole = [(x, -z) for x, z in reversed(upper[1:])] + upper
    return [(nose + chord * x, y, chord * z) for x, z in whole]


def wing():
    span = make_wing.SEMISPAN
    return make_wing.between(section(make_wing.ROOT_CHORD, 0.0, 0.0),
                             section(make_wing.TIP_CHORD, span * math.tan(make_wing.SWEEP), span))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    with open(parser.parse_args().out, "w", encoding="utf-8") as out:
        out.write("\n".join(wing()))


if __name__ == "__main__":
    main()
