# SPDX-License-Identifier: Apache-2.0
"""What bench/compare_peers.py consists of.

machine    this computer, in words
running    one measured run of a tool; interleaved repeats
peers      which tools there are; drivers built on request
shapes     point sets and surfaces, and the files they are given to the tools in
grids      reading what a tool wrote; quality by one routine for all
points, fill, planar    the workloads: cases, tools, commands
results    the JSON file of results; one run extends another
tables     results to the tables of docs/performance.md
"""
