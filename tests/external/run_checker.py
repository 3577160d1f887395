# SPDX-License-Identifier: Apache-2.0
"""Run the shared independent checker (tools/check_mesh.py at $DELFRONT_SHARED, else ../shared) with our arguments."""

import os
import sys

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
shared = os.environ.get("DELFRONT_SHARED") or os.path.join(root, "..", "shared")
checker = os.path.join(shared, "tools", "check_mesh.py")
if not os.path.exists(checker):
    print(f"SKIPPED: no checker at {checker}; set DELFRONT_SHARED")
    sys.exit(77)
os.execv(sys.executable, [sys.executable, checker, *sys.argv[1:]])
