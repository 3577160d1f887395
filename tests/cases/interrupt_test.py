#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C in every stage: exit 130, and nothing half-written."""
import json
import signal
import subprocess
import unittest

import case

OUTPUTS = ["ball.vtu", "ball.msh", "foam/"]


class Interrupt(case.Case):
    def setUp(self):
        super().setUp()
        self.write("ball.stl", case.stl_binary(case.sphere_triangles(5)))
        self.command = [case.DELFRONT, "mesh", "ball.stl", "--growth", "1.2", "--progress", "json", "--report", "r.json"]
        for name in OUTPUTS:
            self.command += ["-o", name]

    def start(self):
        return subprocess.Popen(self.command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                text=True)

    def stages(self):
        """Stages that an undisturbed run shows, in order."""
        with self.start() as process:
            seen = [json.loads(line) for line in process.stderr]
        self.assertEqual(process.returncode, 0)
        return list(dict.fromkeys(event["stage"] for event in seen if event["event"] == "progress"))

    def interrupt_in(self, stage, number):
        with self.start() as process:
            for line in process.stderr:
                event = json.loads(line)
                if event["event"] == "progress" and event["stage"] == stage:
                    process.send_signal(number)
                    break
            rest = process.stderr.read()
        return process.returncode, rest

    def test_in_each_stage(self):
        stages = self.stages()
        for needed in ("read", "check", "tetrahedralize", "recover", "refine", "improve", "write"):
            self.assertIn(needed, stages)
        for name in self.files():
            if name != "ball.stl" and (self.folder / name).is_file():
                (self.folder / name).unlink()
        before = self.files()
        for stage in stages:
            with self.subTest(stage):
                code, rest = self.interrupt_in(stage, signal.SIGINT)
                self.assertEqual(code, 130, rest)
                self.assertIn("interrupted", rest)
                report = self.report("r.json")
                self.assertEqual(report["exit_code"], 130)
                (self.folder / "r.json").unlink()
                if stage != "write":
                    self.assertEqual(report["files_written"], [])
                for name in report["files_written"]:  # complete, and named in the message
                    self.assertIn(name, rest)
                    self.expect(0, "check", name)
                    (self.folder / name).unlink()
                self.assertEqual(self.files(), before)

    def test_terminate_is_the_same(self):
        code, _ = self.interrupt_in("refine", signal.SIGTERM)
        self.assertEqual(code, 130)


if __name__ == "__main__":
    unittest.main()
