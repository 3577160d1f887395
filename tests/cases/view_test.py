#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""delfront view: what it refuses, what it writes, and who can reach what it serves."""
import http.client
import os
import pathlib
import re
import signal
import socket
import subprocess
import time
import unittest

import case


def proc_listeners(port):
    """Addresses that a port is listened on, as /proc shows them."""
    found = []
    for name in ("/proc/net/tcp", "/proc/net/tcp6"):
        try:
            lines = pathlib.Path(name).read_text().splitlines()[1:]
        except OSError:
            continue
        for line in lines:
            local, state = line.split()[1], line.split()[3]
            if state == "0A" and int(local.rsplit(":", 1)[1], 16) == port:
                found.append(local.rsplit(":", 1)[0])
    return found


def prepare(test):
    """A ball to look at; skips where the program has no page."""
    test.write("ball.stl", case.stl_binary(case.sphere_triangles(2)))
    result = test.run_delfront("view", "ball.stl", "--export", "probe.html")
    if "built without its viewer" in case.unbroken(result.stderr):
        test.skipTest("this delfront was built without its viewer (node and npm were missing)")
    (test.folder / "probe.html").unlink()


class Usage(case.Case):
    def setUp(self):
        super().setUp()
        prepare(self)

    def test_what_is_wrong_is_said(self):
        self.expect(2, "view", says="needs a FILE or --job")
        self.expect(2, "view", "ball.stl", "--port", "70000")
        self.expect(2, "view", "ball.stl", "--export", "a.html", "--job", "b", says="leave one of them out")
        self.expect(2, "view", "ball.stl", "--export", "ball.stl", says="would be overwritten")
        self.expect(3, "view", "none.vtu", says="none.vtu")
        self.expect(3, "view", "ball.stl", "ball.stl", says="ball.stl")
        self.expect(7, "view", "ball.stl", "--export", "no/such/folder.html")
        self.write("damaged.vtu", "<VTKFile")
        self.expect(3, "view", "damaged.vtu", "--export", "a.html")
        self.assertEqual(self.files(), ["ball.stl", "damaged.vtu"])

    def test_export_is_one_file_the_same_each_time(self):
        for name, threads in (("a.html", 1), ("b.html", 4)):
            self.expect(0, "view", "ball.stl", "--export", name, "-j", threads, says=name)
        page = (self.folder / "a.html").read_bytes()
        self.assertEqual(page, (self.folder / "b.html").read_bytes())
        self.assertIn(b'id="delfront-data"', page)
        for outside in (b'src="http', b"src='http", b'href="http', b"@import", b"<link rel=\"stylesheet\""):
            self.assertNotIn(outside, page)


class Server(case.Case):
    def setUp(self):
        super().setUp()
        prepare(self)
        environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.process = subprocess.Popen([case.DELFRONT, "view", "ball.stl"], cwd=self.folder, env=environment,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end)
        url = self.process.stdout.readline().strip()
        match = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/", url)
        self.assertTrue(match, url)
        self.port, self.token = int(match[1]), match[2]

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def ask(self, path, host=None, method="GET"):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        connection.putheader("Host", host or f"127.0.0.1:{self.port}")
        connection.endheaders()
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        return answer, body

    def raw(self, data, timeout=20):
        with socket.create_connection(("127.0.0.1", self.port), timeout=timeout) as s:
            s.sendall(data)
            received = b""
            while chunk := s.recv(65536):
                received += chunk
            return received

    def test_page_and_grid_are_served(self):
        answer, body = self.ask(f"/{self.token}/")
        self.assertEqual(answer.status, 200)
        self.assertIn(b"<!--delfront-data-->", body)
        self.assertEqual(answer.headers["Cache-Control"], "no-store")
        self.assertEqual(answer.headers["Referrer-Policy"], "no-referrer")
        answer, grid = self.ask(f"/{self.token}/grid")
        self.assertEqual((answer.status, grid[:7]), (200, b"DFVIEW1"))
        answer, body = self.ask(f"/{self.token}/grid", method="HEAD")
        self.assertEqual((int(answer.headers["Content-Length"]), body), (len(grid), b""))

    def test_wrong_token_is_403(self):
        for path in ("/", "/grid", "/" + "0" * 32 + "/", f"/{self.token[:-1]}/", f"/{self.token}x/"):
            self.assertEqual(self.ask(path)[0].status, 403, path)

    def test_no_path_leads_out(self):
        for path in ("../../../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "..%2f..%2fetc/passwd", "ball.stl", "./grid"):
            self.assertEqual(self.ask(f"/{self.token}/{path}")[0].status, 404, path)

    def test_another_host_is_403(self):
        for host in ("evil.example", f"evil.example:{self.port}", "127.0.0.1:1", "127.0.0.1"):
            self.assertEqual(self.ask(f"/{self.token}/", host=host)[0].status, 403, host)
        self.assertEqual(self.ask(f"/{self.token}/", host=f"localhost:{self.port}")[0].status, 200)

    def test_only_get_and_head(self):
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE"):
            self.assertEqual(self.ask(f"/{self.token}/", method=method)[0].status, 405, method)

    def test_bound_to_this_machine_only(self):
        self.assertEqual(proc_listeners(self.port), ["0100007F"])

    def test_garbage_ends_nothing(self):
        for data in (b"\r\n\r\n", b"\0" * 100 + b"\r\n\r\n", b"GET / HTTP/1.1\r\n\r\n", b"GET /" + b"a" * 20000):
            self.assertRegex(self.raw(data), rb"^HTTP/1.1 4\d\d ")
        idle = [socket.create_connection(("127.0.0.1", self.port)) for _ in range(70)]  # more than are kept
        self.assertEqual(self.ask(f"/{self.token}/grid")[0].status, 200)
        for s in idle:
            s.close()

    def test_ends_on_an_interrupt(self):
        self.process.send_signal(signal.SIGINT)
        self.assertEqual(self.process.wait(timeout=20), 0)


class Job(case.Case):
    def setUp(self):
        super().setUp()
        prepare(self)

    def test_progress_is_served_then_the_grid(self):
        process = subprocess.Popen([case.DELFRONT, "view", "ball.vtu", "--job", "run.jsonl", "--no-browser"], cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        url = process.stdout.readline().strip()
        port, token = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/(\w+)/", url).groups()

        def ask(what):
            connection = http.client.HTTPConnection("127.0.0.1", int(port), timeout=30)
            connection.request("GET", f"/{token}/{what}")
            answer = connection.getresponse()
            return answer.status, answer.read()

        def wait_for(text):
            for _ in range(300):
                status, body = ask("progress")
                if status == 200 and text in body:
                    return
                time.sleep(0.1)
            self.fail(f"{text} is not in {body}")

        wait_for(b'"has_begun":false')
        self.assertEqual(ask("grid")[0], 404)
        with open(self.folder / "run.jsonl", "w") as log:
            subprocess.run([case.DELFRONT, "mesh", "ball.stl", "-o", "ball.vtu", "--progress", "json"], cwd=self.folder,
                           stderr=log, stdout=subprocess.DEVNULL, check=True)
        wait_for(b'"stage":"read"')
        wait_for(b'"grids":1')
        self.assertEqual(ask("grid")[1][:7], b"DFVIEW1")


if __name__ == "__main__":
    unittest.main()
