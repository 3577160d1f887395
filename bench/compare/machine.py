# SPDX-License-Identifier: Apache-2.0
"""This computer, in words."""

import os
import platform
import re
from pathlib import Path


def describe() -> str:
    """Processor, cores, memory, system, compiler-independent: what stands above every table."""
    model, memory = platform.processor() or platform.machine(), 0.0
    try:
        model = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text()).group(1)
        memory = int(re.search(r"MemTotal:\s*(\d+)", Path("/proc/meminfo").read_text()).group(1)) / 2**20
    except (OSError, AttributeError):
        pass
    return f"{model}, {os.cpu_count()} cores, {memory:.0f} GiB, {platform.system()} {platform.release()}"


def load() -> float:
    """Load average of the last minute."""
    return os.getloadavg()[0]
