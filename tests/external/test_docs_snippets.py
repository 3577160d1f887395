# SPDX-License-Identifier: Apache-2.0
"""Every ```toml block of the pages about sizes (and of the README) is a job file that the program takes.

    test_docs_snippets.py DELFRONT

Each block is given to `delfront mesh --print-config` with an input; a key or value it does not know fails. Links of
the pages lead to files that are there.
"""
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
PAGES = ["README.md", *sorted(f"docs/sizes/{f}" for f in os.listdir(os.path.join(ROOT, "docs/sizes"))
                              if f.endswith(".md")), "examples/sizes/README.md"]


def blocks_of(text):
    """The blocks, each with the number of its first line."""
    return [(text[: m.start(1)].count("\n") + 1, m[1]) for m in re.finditer(r"^```toml\n(.*?)^```", text, re.M | re.S)]


def dead_links(page, text):
    folder = os.path.dirname(os.path.join(ROOT, page))
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text)
    return [link for link in links if "://" not in link and not os.path.exists(os.path.join(folder, link))]


def main():
    delfront, failed, count = os.path.abspath(sys.argv[1]), 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for page in PAGES:
            with open(os.path.join(ROOT, page), encoding="utf-8") as file:
                text = file.read()
            for link in dead_links(page, text):
                print(f"{page} FAILED: link to {link}, which is not there")
                failed += 1
            for line, block in blocks_of(text):
                count += 1
                job = os.path.join(folder, "case.toml")
                with open(job, "w", encoding="utf-8") as file:
                    file.write(block)
                given = [] if "[input]" in block else ["--set", "input.files=body.stl"]
                command = [delfront, "mesh", job, "--print-config", "--set", "output.files=body.vtu", *given]
                done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
                if done.returncode != 0:
                    print(f"{page}:{line} FAILED: exit {done.returncode}: {done.stderr.strip()}")
                    failed += 1
    print(f"{count} blocks, {failed} failed")
    sys.exit(1 if failed or count < 10 else 0)


if __name__ == "__main__":
    main()
