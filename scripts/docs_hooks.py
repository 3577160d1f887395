# SPDX-License-Identifier: Apache-2.0
"""What mkdocs calls (mkdocs.yml): pages link to files outside docs/, which its pages must not leave.

Files of examples/ and the texts at the root that pages link to become part of the site under their own path, with the
pages' links turned towards them; of links to other files only the text stays, with the path behind it.
"""
import os
import re

from mkdocs.structure.files import File

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
DOCS = os.path.join(ROOT, "docs")
TAKEN = re.compile(r"(examples/.+|CHANGELOG\.md|ARCHITECTURE\.md)$")
ALWAYS = ["CHANGELOG.md", "ARCHITECTURE.md"]  # of the navigation
LINK = re.compile(r"(!?)\[((?:`[^`]*`|[^\]`])*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
FENCE = re.compile(r"(^ *```.*?^ *```[^\n]*$)", re.M | re.S)


def path_in_project(source, link):
    """Where a link of a page leads, from the root of the project; None where it leads out of it or to the net."""
    if "://" in link or link.startswith("mailto:"):
        return None
    path = os.path.relpath(os.path.normpath(os.path.join(os.path.dirname(source), link)), ROOT)
    return None if path.startswith("..") or not os.path.exists(os.path.join(ROOT, path)) else path


def path_in_site(path):
    """The name that a file has among the pages; None where the site does not hold it."""
    if path.startswith("docs" + os.sep):
        return os.path.relpath(path, "docs") if os.path.isfile(os.path.join(ROOT, path)) else None
    return path if TAKEN.fullmatch(path) and os.path.isfile(os.path.join(ROOT, path)) else None


def text_of(source):
    with open(source, encoding="utf-8") as file:
        return file.read()


def linked_from(source):
    """Files outside docs/ that the site has to hold for this page."""
    for match in LINK.finditer(FENCE.sub("", text_of(source))):
        path = path_in_project(source, match[3])
        if path and path_in_site(path) and not path.startswith("docs" + os.sep):
            yield path


def on_files(files, config):
    waiting = [os.path.join(ROOT, path) for path in ALWAYS] + [f.abs_src_path for f in files if f.is_documentation_page()]
    held = set(ALWAYS)
    while waiting:
        for path in linked_from(waiting.pop()):
            if path not in held:
                held.add(path)
                if path.endswith(".md"):
                    waiting.append(os.path.join(ROOT, path))
    for path in sorted(held):
        files.append(File(path, ROOT, config["site_dir"], config["use_directory_urls"]))
    return files


def turned(match, source, folder):
    """One link as the site needs it; `folder`: that of the page among the pages."""
    mark, text, link, anchor = match[1], match[2], match[3], match[4] or ""
    path = path_in_project(source, link)
    if path is None:
        return match[0]
    inside = path_in_site(path)
    if inside:
        return f"{mark}[{text}]({os.path.relpath(inside, folder or '.')}{anchor})"
    return text if path in text else f"{text} (`{path}`)"


def on_page_markdown(markdown, page, config, files):
    source, folder = page.file.abs_src_path, os.path.dirname(page.file.src_path)
    parts = FENCE.split(markdown)
    for i in range(0, len(parts), 2):  # fenced blocks stay as they are
        parts[i] = LINK.sub(lambda match: turned(match, source, folder), parts[i])
        # A list may follow a line of text at once, as everywhere but here.
        parts[i] = re.sub(r"(?m)^((?![-*|#>\s]|\d+\. ).*\n)(?=(?:- |1\. ))", r"\1\n", parts[i])
    return "".join(parts)
