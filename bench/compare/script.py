# SPDX-License-Identifier: Apache-2.0
"""What the scripts of this folder share: lists in options, and results put between marks of a page."""

import json
from pathlib import Path


def numbers(text: str) -> list[int]:
    return [int(float(word)) for word in text.split(",") if word]


def words(text: str) -> list[str]:
    return [word for word in text.split(",") if word]


def marks(maker: str) -> tuple[str, str]:
    """Lines of a page between which stands what the script `maker` of bench/ made."""
    return f"<!-- begin: made by bench/{maker} -->", f"<!-- end: made by bench/{maker} -->"


def between(path: Path, maker: str) -> str:
    """What the page says between the marks."""
    begin, end = marks(maker)
    return path.read_text(encoding="utf-8").split(begin, 1)[1].split(end, 1)[0].strip()


def replace_between(path: Path, maker: str, text: str) -> None:
    """Put the text between the marks of the page, or with them at its end; the rest stays."""
    begin, end = marks(maker)
    page = path.read_text(encoding="utf-8") if path.exists() else "# Performance\n"
    if begin in page and end in page:
        before, rest = page.split(begin, 1)
        page = before + begin + "\n" + text.rstrip() + "\n" + end + rest.split(end, 1)[1]
    else:
        page = page.rstrip() + f"\n\n{begin}\n{text.rstrip()}\n{end}\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page, encoding="utf-8")


def publish(text: str, path: Path, maker: str, writes: bool) -> int:
    """Print the results and, where asked, put them into the page; the script's exit status."""
    print(text)
    if writes:
        replace_between(path, maker, text)
    return 0


def stages(folder: Path) -> dict[str, float]:
    """Seconds of each stage of the run whose report.json lies in the folder, rounds added up."""
    seconds: dict[str, float] = {}
    for stage in json.loads((folder / "report.json").read_text())["stages"]:
        seconds[stage["stage"]] = seconds.get(stage["stage"], 0.0) + stage["seconds"]
    return seconds
