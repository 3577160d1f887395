# SPDX-License-Identifier: Apache-2.0
"""The documentation as a site: built strictly, whole, and nothing in it comes from a network.

    test_docs_site.py DELFRONT

Also: docs/options.md is what the program says of itself, and the messages of docs/troubleshooting.md are in the sources.
Exit 77 where mkdocs is not there.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
ASSETS = {("img", "src"), ("script", "src"), ("link", "href"), ("source", "src"), ("video", "src"), ("audio", "src"),
          ("iframe", "src"), ("object", "data"), ("embed", "src"), ("input", "src"), ("video", "poster")}
PROGRAM = ""


class Page(HTMLParser):
    """All that a page refers to, and the places in it that others can refer to."""

    def __init__(self, path):
        super().__init__()
        self.links, self.assets, self.names = [], [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        for key, value in attrs:
            if key in ("id", "name") and value:
                self.names.add(value)
            elif (tag, key) in ASSETS:
                self.assets.append(value)
            elif (tag, key) == ("a", "href"):
                self.links.append(value)
            elif key in ("style", "srcset") and value:
                self.assets += re.findall(r"(?:https?:)?//[^\s'\")]+", value)

    def handle_data(self, data):
        if self.lasttag == "style":
            self.assets += re.findall(r"(?:https?:)?//[^\s'\")]+", data)


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="delfront_site_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.built = subprocess.run(["mkdocs", "build", "--strict", "--site-dir", cls.folder / "site"], cwd=ROOT,
                                   capture_output=True, text=True, check=False)
        cls.site = cls.folder / "site"
        cls.pages = {path: Page(path) for path in sorted(cls.site.rglob("*.html"))}

    def test_it_is_built_without_a_warning(self):
        self.assertEqual(self.built.returncode, 0, self.built.stdout + self.built.stderr)
        self.assertNotIn("WARNING", self.built.stderr)
        named = re.search(r"not included in the \"nav\".*?((?:\n +- .*)+)", self.built.stderr)
        outside = [line.strip(" -") for line in named[1].splitlines() if line.strip()] if named else []
        self.assertEqual([page for page in outside if not page.startswith("examples/")], [], "pages that no menu names")

    def test_every_page_of_docs_is_in_it(self):
        self.assertEqual(self.built.returncode, 0)
        for page in sorted((ROOT / "docs").rglob("*.md")):
            name = page.relative_to(ROOT / "docs").with_suffix(".html")
            name = name.with_name("index.html") if name.name == "README.html" else name
            self.assertTrue((self.site / name).is_file(), name)

    def test_every_link_and_picture_is_there(self):
        count = 0
        for path, page in self.pages.items():
            for link in page.links + page.assets:
                parts = urlsplit(link)
                if parts.scheme or parts.netloc:
                    continue
                target = path if not parts.path else path.parent / unquote(parts.path)
                if parts.path.startswith("/"):  # only the page of a server's error 404 knows no place of its own
                    self.assertEqual(path.name, "404.html", link)
                    target = self.site / parts.path.lstrip("/")
                target = pathlib.Path(os.path.normpath(target))
                target = target / "index.html" if target.is_dir() else target
                shown = f"{path.relative_to(self.site)}: {link}"
                self.assertTrue(target.is_file(), shown)
                self.assertTrue(target.is_relative_to(self.site), shown)
                if parts.fragment and target in self.pages:
                    self.assertIn(unquote(parts.fragment), self.pages[target].names, shown)
                count += 1
        self.assertGreater(count, 500)

    def test_nothing_is_loaded_from_a_network(self):
        for path, page in self.pages.items():
            for asset in page.assets:
                self.assertEqual((urlsplit(asset).scheme, urlsplit(asset).netloc), ("", ""), f"{path.name}: {asset}")
        styles = list(self.site.rglob("*.css"))
        self.assertGreater(len(styles), 0)
        for path in styles:
            text = path.read_text(encoding="utf-8")
            self.assertEqual(re.findall(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//[^)'\"\s]*", text), [], path)


class Pages(unittest.TestCase):
    def test_the_options_are_those_of_the_program(self):
        script = ROOT / "scripts" / "options_page.py"
        done = subprocess.run([sys.executable, script, "--delfront", PROGRAM, "--check"], capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_another_page_of_options_is_noticed(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "options.md"
            page.write_text((ROOT / "docs" / "options.md").read_text().replace("`hmax`", "`hmaxx`", 1))
            script = ROOT / "scripts" / "options_page.py"
            done = subprocess.run([sys.executable, script, "--delfront", PROGRAM, "--check", "--out", page],
                                  capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("out of date", done.stderr)

    def test_messages_that_are_explained_are_those_of_the_program(self):
        text = "".join(path.read_text(encoding="utf-8") for folder in ("src", "cli") for path in
                       sorted((ROOT / folder).rglob("*.cpp")))
        text = re.sub(r'"\s*\n?\s*"', "", text)  # texts that go on in the next line
        system = "No such file or directory"
        titles = re.findall(r"^### `(.*)`$", (ROOT / "docs" / "troubleshooting.md").read_text(), re.M)
        self.assertGreaterEqual(len(titles), 25)
        for title in titles:
            for part in title.split("…"):
                self.assertTrue(part in text or part == system, title)


if __name__ == "__main__":
    if not shutil.which("mkdocs"):
        print("docs_site skipped: mkdocs is not there; scripts/setup installs it")
        sys.exit(77)
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
