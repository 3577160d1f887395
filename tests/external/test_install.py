#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What is installed works elsewhere: the program, find_package, Debian packages, the manual page, completion in bash.

    test_install.py BUILD_FOLDER PROGRAM
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD, PROGRAM = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
BOX = """[[shape]]
type = "box"
min = [0, 0, 0]
max = [1, 1, 1]
"""


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=500, **options)
    if done.returncode:
        raise AssertionError(f"$ {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


class Installed(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="delfront_install_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def grid_a_box(self, program):
        (self.folder / "box.geom.toml").write_text(BOX)
        run(program, "mesh", "box.geom.toml", "-o", "box.vtu", "-q", cwd=self.folder)
        self.assertIn("tetra", run(program, "info", "box.vtu", cwd=self.folder))

    def install(self, prefix, *components):
        for component in components:
            run("cmake", "--install", BUILD, "--prefix", prefix, "--component", component)

    def test_the_program(self):
        self.install(self.folder / "usr", "program")
        self.grid_a_box(self.folder / "usr" / "bin" / "delfront")
        self.assertTrue((self.folder / "usr" / "share" / "man" / "man1" / "delfront.1").is_file())

    def test_a_project_that_uses_the_library(self):
        prefix = self.folder / "usr"
        self.install(prefix, "development")
        run("cmake", "-S", ROOT / "tests" / "external" / "consumer", "-B", self.folder / "build",
            f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Release")
        run("cmake", "--build", self.folder / "build")
        self.assertEqual(run(self.folder / "build" / "consumer"), "volume 0.166667\n")
        for header in (prefix / "include").rglob("*.hpp"):
            self.assertNotIn(str(ROOT), header.read_text())

    @unittest.skipUnless(shutil.which("dpkg-deb"), "dpkg-deb is not there")
    def test_debian_packages(self):
        run("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", self.folder, cwd=self.folder)
        packages = sorted(self.folder.glob("*.deb"))
        names = [run("dpkg-deb", "-f", p, "Package").strip() for p in packages]
        self.assertIn("delfront", names)
        self.assertIn("libdelfront-dev", names)
        main = packages[names.index("delfront")]
        self.assertIn("libc6", run("dpkg-deb", "-f", main, "Depends"))
        for package in packages:
            run("dpkg-deb", "-x", package, self.folder / "root")
        program = self.folder / "root" / "usr" / "bin" / "delfront"
        self.grid_a_box(program)
        if "delfront-cad" in names:
            (self.folder / "part.step").write_text("ISO-10303-21;\n")
            told = subprocess.run([program, "info", "part.step"], cwd=self.folder, capture_output=True, text=True)
            self.assertNotIn("libdelfront_cad.so is not there", told.stderr)


class Documents(unittest.TestCase):
    def test_the_manual_page_is_that_of_the_program(self):
        run(sys.executable, ROOT / "scripts" / "man_page.py", "--delfront", PROGRAM, "--check")

    def complete(self, *words):
        script = (f"source {ROOT}/packaging/completion.bash; COMP_WORDS=({PROGRAM} {' '.join(words)} ''); "
                  f"COMP_CWORD={len(words)}; COMP_WORDS[COMP_CWORD]='{words[-1]}'; _delfront; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
        return run("bash", "-c", script, env=dict(os.environ)).split()

    def test_completion(self):
        self.assertEqual(self.complete("me"), ["mesh"])
        self.assertIn("--hmax", self.complete("mesh", "--h"))
        self.assertEqual(self.complete("mesh", "--accuracy", "f"), ["fine"])
        self.assertIn("front-delaunay", self.complete("mesh", "--volume-method", "f"))


if __name__ == "__main__":
    sys.exit(unittest.main(argv=sys.argv[:1]))
