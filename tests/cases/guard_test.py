#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A CAD library that crashes, hangs or is killed: the run says which file it was, and nothing is left behind."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

import case

MODULE = os.environ.get("DELFRONT_CRASHING_MODULE", "")


def processes_of(folder):
    """Of this system, those that run in a folder."""
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if os.readlink(process / "cwd") == str(folder):
                found.append(int(process.name))
        except OSError:
            pass
    return found


class Guard(case.Case):
    def setUp(self):
        super().setUp()
        if not MODULE:
            self.skipTest("DELFRONT_CRASHING_MODULE names no module")
        self.env = dict(os.environ, DELFRONT_CAD_MODULE=MODULE)

    def tearDown(self):
        self.assertEqual(processes_of(self.folder.resolve()), [], "processes that were left behind")

    def start(self, *arguments):
        process = subprocess.Popen([case.DELFRONT, *arguments, "--progress", "json"], cwd=self.folder, env=self.env,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        sign = self.folder / "part.step.at_work"  # the module makes it, in whatever process that is
        while not sign.exists():
            time.sleep(0.01)
        sign.unlink()
        return process

    def test_a_crash_is_bad_input_with_the_name_of_the_file(self):
        for name, word in (("part.step", "crash"), ("part.igs", "abort"), ("part.brep", "crash")):
            self.write(name, word)
            kind = {"crash": "Segmentation fault", "abort": "Aborted"}[word]
            for command in (("info", name), ("check", name), ("mesh", name, "-o", "part.su2")):
                before = self.files()
                result = self.expect(3, *command, env=self.env, says=["crashed while reading " + name, kind, "export it"])
                self.assertEqual(self.files(), before)
                self.assertEqual(result.stdout, "")

    def test_a_job_file_and_json(self):
        self.write("part.step", "crash")
        self.write("job.toml", '[input]\nfiles = ["part.step"]\n[output]\nfiles = ["part.su2"]\n')
        result = self.run_delfront("mesh", "job.toml", "--progress", "json", env=self.env)
        self.assertEqual(result.returncode, 3)
        events = [json.loads(line) for line in result.stderr.splitlines()]
        self.assertEqual(events[-1]["event"], "error")
        self.assertEqual(events[-1]["exit_code"], 3)
        self.assertIn("progress", [event["event"] for event in events])

    def test_killed_for_its_memory(self):
        self.write("part.step", "kill")
        self.expect(6, "info", "part.step", env=self.env, says="killed while reading part.step")

    def test_an_error_is_handed_on(self):
        self.write("part.step", "other")
        self.expect(3, "info", "part.step", env=self.env, says="part.step: made to fail")

    def test_a_limit_of_time_ends_what_hangs(self):
        self.write("part.step", "hang")
        self.expect(6, "mesh", "part.step", "-o", "p.su2", "--time-limit", "1", env=self.env, says="the time limit of 1 s")

    def test_interrupted_where_it_listens_and_where_it_does_not(self):
        for word in ("wait", "hang"):
            self.write("part.step", word)
            for number in (signal.SIGINT, signal.SIGTERM):
                process = self.start("mesh", "part.step", "-o", "part.su2")
                process.send_signal(number)
                said = process.stderr.read()
                self.assertEqual(process.wait(60), 130, said)
                self.assertIn("interrupted; nothing was written", said)
                self.assertEqual(self.files(), ["part.step"])

    def test_a_second_interruption_ends_it_at_once(self):
        self.write("part.step", "hang")
        process = self.start("info", "part.step")
        began = time.monotonic()
        process.send_signal(signal.SIGINT)
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(60), 130)
        self.assertLess(time.monotonic() - began, 4)

    def test_the_child_does_not_outlive_its_parent(self):
        self.write("part.step", "hang")
        process = self.start("info", "part.step")
        self.assertEqual(len(processes_of(self.folder.resolve())), 2)
        process.kill()
        process.wait(60)
        for _ in range(100):
            if not processes_of(self.folder.resolve()):
                break
            time.sleep(0.05)

    def test_what_is_no_cad_file_has_no_second_process(self):
        self.write("ball.stl", case.stl_binary(case.sphere_triangles(5)))
        process = subprocess.Popen([case.DELFRONT, "mesh", "ball.stl", "--growth", "1.2", "-o", "ball.vtu", "--progress",
                                    "json"], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        with process:
            process.stderr.readline()
            self.assertEqual(processes_of(self.folder.resolve()), [process.pid])
            process.kill()


class LibraryGuard(case.Case):
    def test_a_crash_of_hdf5_is_bad_input_with_the_name_of_the_file(self):
        library = os.environ.get("DELFRONT_CRASHING_HDF5", "")
        if not library:
            self.skipTest("DELFRONT_CRASHING_HDF5 names no library")
        env = dict(os.environ, LD_PRELOAD=library, ASAN_OPTIONS="verify_asan_link_order=0:handle_segv=0:detect_leaks=0")
        self.write("grid.vtkhdf", "\x89HDF")
        self.write("case.toml", '[input]\nfiles = ["grid.vtkhdf"]\n[output]\nfiles = ["out.vtu"]\n')
        for command in (("info", "grid.vtkhdf"), ("check", "grid.vtkhdf"), ("convert", "grid.vtkhdf", "out.vtu"),
                        ("refine", "grid.vtkhdf", "-o", "out.vtu"), ("mesh", "case.toml")):
            before = self.files()
            self.expect(3, *command, env=env, says=["HDF5 crashed while reading", "grid.vtkhdf", "Segmentation fault", "VTU"])
            self.assertEqual(self.files(), before)


if __name__ == "__main__":
    sys.exit(unittest.main())
