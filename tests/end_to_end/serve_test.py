#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""fathom serve as programs meet it: strangers are refused, measurements run, a killed server puts the
lens back. serve_test.py FATHOM
"""

import http.client
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

FATHOM = sys.argv[1]
TOKEN = "0123456789abcdef"
# Only for a test that hangs; nothing is measured by it.
PATIENCE_S = 120


class Service:
    """A running service in a folder of its own, and what it is asked."""

    def __init__(self, rig, *options):
        self.home = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.home.name) / "kept"
        environment = dict(os.environ, XDG_STATE_HOME=self.home.name, FATHOM_TOKEN=TOKEN)
        self.process = subprocess.Popen(
            [FATHOM, "serve", "--rig", rig, "--port", "0", "--folder", self.folder, *options],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
        self.address = self.process.stdout.readline().strip()
        self.port = int(self.address.split(":")[2].split("/")[0])

    def ask(self, method, path, body=None, client=None, **headers):
        """Status, headers and body of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        headers = {"Authorization": f"Bearer {TOKEN}", **headers}
        if client:
            headers["X-Fathom-Client"] = client
        if method == "POST":
            headers.setdefault("Content-Type", "application/json")
            body = json.dumps(body or {})
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer.status, dict(answer.getheaders()), content

    def post(self, path, body=None, client=None):
        status, _, content = self.ask("POST", f"/api/v1/{path}", body, client)
        return status, json.loads(content)

    def get(self, path):
        return json.loads(self.ask("GET", f"/api/v1/{path}")[2])

    def raw(self, text):
        """What the very bytes of a request are answered with."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE_S) as connection:
            connection.sendall(text.encode() if isinstance(text, str) else text)
            answer = b""
            while part := connection.recv(65536):
                answer += part
        return answer.decode("latin-1")

    def end(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        _, words = self.process.communicate(timeout=PATIENCE_S)
        self.home.cleanup()
        return self.process.returncode, words


class Events(threading.Thread):
    """Reads events until the service ends."""

    def __init__(self, service, client="watcher"):
        super().__init__(daemon=True)
        self.condition = threading.Condition()
        self.events = []
        self.ids = []
        self.is_over = False
        self.connection = http.client.HTTPConnection("127.0.0.1", service.port, timeout=PATIENCE_S)
        self.connection.request("GET", f"/api/v1/events?client={client}",
                                headers={"Authorization": f"Bearer {TOKEN}"})
        self.answer = self.connection.getresponse()
        self.start()

    def run(self):
        kind = None
        try:
            for line in self.answer:
                name, _, value = line.decode().rstrip("\n").partition(": ")
                with self.condition:
                    if name == "id":
                        self.ids.append(int(value))
                    if name == "event":
                        kind = value
                    if name == "data":
                        self.events.append((kind, json.loads(value)))
                        self.condition.notify_all()
        except (OSError, http.client.HTTPException):
            pass
        with self.condition:
            self.is_over = True
            self.condition.notify_all()

    def wait(self, kind, suits=lambda data: True):
        """The first event of a kind that was not waited for before."""
        def found():
            return next((i for i, (k, d) in enumerate(self.events) if k == kind and suits(d)), None)
        with self.condition:
            self.condition.wait_for(lambda: found() is not None or self.is_over, PATIENCE_S)
            at = found()
            assert at is not None, f"no {kind} among {[k for k, _ in self.events][-20:]}"
            data = self.events[at][1]
            del self.events[:at + 1]
            return data


class Refusals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.service = Service("sim")

    @classmethod
    def tearDownClass(cls):
        cls.service.end()

    def head(self, **changes):
        lines = {"Host": f"127.0.0.1:{self.service.port}", "Authorization": f"Bearer {TOKEN}",
                 "Connection": "close", **changes}
        return "".join(f"{name}: {value}\r\n" for name, value in lines.items() if value is not None)

    def expect(self, status, request, code=None):
        answer = self.service.raw(request)
        self.assertTrue(answer.startswith(f"HTTP/1.1 {status} "), answer[:200])
        self.assertIn("X-Content-Type-Options: nosniff", answer)
        self.assertIn("Cache-Control: no-store", answer)
        if code:
            self.assertEqual(json.loads(answer.split("\r\n\r\n", 1)[1])["error"]["code"], code)
        return answer

    def get(self, path="/api/v1/state", **changes):
        return f"GET {path} HTTP/1.1\r\n{self.head(**changes)}\r\n"

    def post(self, body="{}", path="/api/v1/stop", **changes):
        changes = {"Content-Type": "application/json", "Content-Length": len(body), **changes}
        return f"POST {path} HTTP/1.1\r\n{self.head(**changes)}\r\n{body}"

    def test_who_has_no_token(self):
        self.expect(200, self.get())
        self.expect(401, self.get(Authorization=None), "no_token")
        self.expect(401, self.get(Authorization="Bearer 0123456789abcdeg"), "no_token")
        self.expect(401, self.get(path="/", Authorization=None), "no_token")
        self.expect(401, self.get(path="/api", Authorization=None), "no_token")
        self.expect(401, self.get(path="/page/api.js", Authorization=None), "no_token")
        self.expect(401, self.get(path="/?token=wrong", Authorization=None), "no_token")

    def test_the_printed_address_gives_a_cookie(self):
        answer = self.expect(303, self.get(path=f"/?token={TOKEN}", Authorization=None))
        self.assertIn("HttpOnly; SameSite=Strict; Path=/", answer)
        self.assertIn("Location: /\r\n", answer)
        cookie = answer.split("Set-Cookie: ")[1].split(";")[0]
        self.expect(200, self.get(Authorization=None, Cookie=cookie))

    def test_pages_of_others(self):
        self.expect(421, self.get(Host="evil.example"), "foreign_host")
        self.expect(421, self.get(Host=None), "foreign_host")
        self.expect(403, self.get(Origin="http://evil.example"), "foreign_origin")
        self.expect(403, self.post(Origin="null"), "foreign_origin")
        self.expect(200, self.post(Origin=f"http://127.0.0.1:{self.service.port}"))

    def test_bodies(self):
        self.expect(415, self.post(**{"Content-Type": "text/plain"}), "not_json")
        self.expect(415, self.post(**{"Content-Type": None}), "not_json")
        self.expect(411, self.post(**{"Content-Length": None}), "no_length")
        self.expect(411, self.post(**{"Content-Length": None, "Transfer-Encoding": "chunked"}))
        self.expect(413, self.post(**{"Content-Length": 70000}), "large_body")
        self.expect(400, self.post(**{"Content-Length": "2, 2"}), "unclear_length")
        self.expect(400, self.get(**{"Content-Length": 5}), "body_of_get")
        self.expect(400, self.post(body="{"), "bad_argument")
        self.expect(400, self.post(body="[" * 60000), "bad_argument")
        self.expect(400, self.post(body='{"a":1}'), "bad_argument")

    def test_a_refused_body_is_no_second_request(self):
        inner = self.get()
        answer = self.service.raw(self.post(body=inner, **{"Content-Type": "text/plain"}))
        self.assertEqual(answer.count("HTTP/1.1 "), 1)

    def test_a_connection_goes_on_after_what_was_read_whole(self):
        twice = self.get(Connection=None) + self.get(path="/api")
        answer = self.service.raw(twice)
        self.assertEqual(answer.count("HTTP/1.1 200 "), 2)
        for first in (self.get(path="/nothing", Connection=None), self.post(Connection=None),
                      self.get(Connection=None, **{"Content-Length": 3}),
                      self.get(path="/api/v1/stream.mjpg?fps=0", Connection=None)):
            answer = self.service.raw(first + self.get())
            self.assertEqual(answer.count("HTTP/1.1 "), 1, first)
            self.assertIn("Connection: close", answer)

    def test_sizes_and_methods(self):
        self.expect(431, self.get(Cookie="a" * 9000), "large_head")
        self.expect(431, f"GET /{'a' * 9000} HTTP/1.1\r\n{self.head()}\r\n", "large_head")
        self.expect(414, self.get(path="/" + "a" * 300), "long_path")
        self.expect(405, f"PUT / HTTP/1.1\r\n{self.head()}Content-Length: 0\r\n\r\n", "method")
        self.expect(404, self.get(path="/api/v1/nothing"), "not_found")

    def test_paths_lead_nowhere(self):
        for path in ("/api/v1/runs/..%2f..%2fetc%2fpasswd", "/page/../service.cpp", "/page/%2e%2e/x",
                     "/api/v1/runs/../../etc/passwd", "//etc/passwd"):
            answer = self.service.raw(self.get(path=path))
            self.assertTrue(answer.startswith("HTTP/1.1 404 "), f"{path}: {answer[:100]}")

    def test_headers(self):
        answer = self.expect(200, self.get())
        policy = answer.split("Content-Security-Policy: ")[1].split("\r\n")[0]
        self.assertIn("default-src 'none'", policy)
        self.assertNotIn("unsafe", policy)
        self.assertIn("Referrer-Policy: no-referrer", answer)
        self.assertIn("frame-ancestors 'none'", policy)

    def test_too_many(self):
        # Connections that say nothing: the service has 128 places for them, and 10 s patience.
        idle = [socket.create_connection(("127.0.0.1", self.service.port)) for _ in range(140)]
        try:
            answer = idle[-1].recv(65536).decode()
            self.assertTrue(answer.startswith("HTTP/1.1 429 "), answer)
        finally:
            for one in idle:
                one.close()
        # Their places are free again, sooner or later; then one that begins a request and stops.
        slow = "HTTP/1.1 429"
        while slow.startswith("HTTP/1.1 429"):
            slow = self.service.raw("GET / HT")
        self.assertTrue(slow.startswith("HTTP/1.1 408 "), slow)

    def test_description_names_every_address(self):
        paths = json.loads(self.service.ask("GET", "/api")[2])["paths"]
        for path in ("state", "events", "stream.mjpg", "focus", "calibrate/next", "runs/{id}/rerun"):
            self.assertIn(f"/api/v1/{path}", paths)


class Measuring(unittest.TestCase):
    def setUp(self):
        self.service = Service("sim:target=seedling,distance=1800")
        self.addCleanup(lambda: self.service.process.poll() is None and self.service.end())

    def measure(self, events, kind, body=None):
        return self.measure_on(self.service, events, kind, body)

    def measure_on(self, service, events, kind, body=None):
        status, answer = service.post(kind, body)
        self.assertEqual(status, 202, answer)
        result = events.wait("found")
        ended = events.wait("ended")
        self.assertEqual((ended["id"], ended["kind"]), (answer["id"], kind))
        return ended["status"], result

    def test_focus_range_and_runs(self):
        service, events = self.service, Events(self.service)
        first = events.wait("state")
        self.assertEqual((first["activity"], first["drive"]["driver"]), ("live", None))
        status, focus = self.measure(events, "focus")
        self.assertEqual((status, focus["verdict"]), ("done", "focused"))
        self.assertEqual(service.get("state")["lens"]["position"], round(focus["position"]))
        self.calibrate(events)
        status, ranged = self.measure(events, "range", {"calibration": "desk"})
        self.assertEqual(status, "done")
        distance = ranged["distance"]
        self.assertLess(abs(distance["value"] - 2400), 5 * distance["sigma"] + 5)
        self.assertEqual(service.post("range", {"calibration": "../desk"})[0], 400)
        runs = service.get("runs")
        self.assertEqual([run["kind"] for run in runs], ["range", "calibrate", "focus"])
        self.assertEqual(runs[0]["id"], ranged["run"])
        for run in runs:
            self.assertTrue(service.post(f"runs/{run['id']}/rerun")[1]["same"], run)
        kept = json.loads(service.ask("GET", f"/api/v1/runs/{runs[2]['id']}/file")[2])
        self.assertEqual(kept["format"], "fathom-run")
        ids = events.ids
        self.assertEqual(ids[1:], list(range(ids[1], ids[1] + len(ids) - 1)))

    def calibrate(self, events):
        """The stage is left at the last distance."""
        service = self.service
        self.assertEqual(service.post("calibrate", {"name": "desk"})[0], 202)
        for distance in (1500, 1800, 2100, 2400):
            events.wait("state", lambda s: (s["calibration"] or {}).get("waiting_for_next"))
            self.assertEqual(service.post("calibrate/next", {"distance": distance})[0], 200)
        events.wait("state", lambda s: s["calibration"]["waiting_for_next"] and
                    len(s["calibration"]["points"]) == 4)
        self.assertEqual(service.post("calibrate/done")[0], 200)
        self.assertEqual(events.wait("ended")["status"], "done")
        state = service.get("state")
        self.assertEqual(len(state["calibration"]["fit"]["residuals_mm"]), 4)
        self.assertIn("desk", state["calibrations"])

    def test_sweep_depth_and_capture(self):
        service, events = self.service, Events(self.service)
        _, sweep = self.measure(events, "sweep", {"from": 700, "to": 850, "step": 10})
        self.assertAlmostEqual(sweep["position"], 784, delta=12)
        self.assertEqual(service.get("state")["lens"]["position"], 0)
        _, depth = self.measure(events, "depth", {"from": 700, "to": 850, "step": 15})
        self.assertTrue((service.folder / depth["folder"] / "report.json").is_file())
        values = service.get("state")["map"]["values"]
        self.assertTrue(any(value and abs(value - 784) < 20 for value in values))
        _, capture = self.measure(events, "capture", {"frames": 2})
        self.assertEqual(len(list((service.folder / capture["folder"]).glob("*.png"))), 2)

    def test_what_is_learned_of_the_blur_makes_the_next_search_quicker(self):
        service = Service("sim:optics=untold,start=500,target=seedling,distance=1800")
        self.addCleanup(lambda: service.process.poll() is None and service.end())
        events = Events(service)
        travels = []
        for _ in range(2):
            service.post("lens", {"position": 500})
            events.wait("state", lambda s: s["lens"]["position"] == 500 and not s["lens"]["moving"])
            self.assertEqual(self.measure_on(service, events, "focus")[0], "done")
            run = service.get("runs")[0]["id"]
            kept = json.loads(service.ask("GET", f"/api/v1/runs/{run}/file")[2])
            places = [one["position"] for one in kept["runs"][-1]["evaluations"]]
            travels.append(sum(abs(b - a) for a, b in zip(places, places[1:])))
        self.assertLess(travels[1], 0.5 * travels[0])
        self.assertEqual(len(list((service.folder / "blur").iterdir())), 1)

    def test_a_window_is_found(self):
        service = Service("sim:target=stair,distance=1500")
        self.addCleanup(service.end)
        events = Events(service)
        events.wait("state")
        where = service.get("state")["lens"]["position"]
        found = {wish: self.measure_on(service, events, "aim", {"window": wish, "from": 700, "to": 1100})[1]
                 for wish in ("auto", "nearest")}
        for wish, result in found.items():
            window = result["window"]
            self.assertIn(f"window {window['x']},{window['y']},{window['n']}: ", result["words"])
            self.assertIn(window["n"], (32, 64))  # a tread is 64 px wide, and its edges hold two depths
        self.assertIn("on the nearest surface", found["nearest"]["words"])
        state = service.get("state")
        self.assertEqual(state["windows"], [found["nearest"]["window"]])
        self.assertEqual(state["lens"]["position"], where)
        # What stands to the right is nearer there, by the target's own law.
        self.assertGreater(found["nearest"]["window"]["x"], 128)
        _, none = self.measure_on(service, events, "aim", {"from": 0, "to": 300})
        self.assertIsNone(none["window"])
        self.assertIn("no window: ", none["words"])
        self.assertEqual(service.get("state")["windows"], [found["nearest"]["window"]])
        for body in ({"window": "other"}, {"window": 5}, {"calibration": "none"}, {"step": 3}):
            self.assertEqual(service.post("aim", body)[0], 400, body)

    def test_stop_puts_the_lens_back_and_keeps_the_run(self):
        service, events = self.service, Events(self.service)
        service.post("lens", {"position": 300})
        events.wait("state", lambda s: s["lens"]["position"] == 300 and not s["lens"]["moving"])
        service.post("sweep", {"step": 1})
        events.wait("evaluated")
        self.assertEqual(service.post("focus")[1]["error"]["code"], "busy")
        self.assertEqual(service.post("windows", {"windows": [{"x": 0, "y": 0, "n": 64}]})[0], 409)
        for _ in range(3):  # an impatient finger does not keep the lens from going back
            self.assertEqual(service.post("stop", client="passer-by")[0], 200)
        self.assertEqual(events.wait("ended")["status"], "stopped")
        state = service.get("state")
        self.assertEqual((state["activity"], state["lens"]["position"]), ("live", 300))
        self.assertEqual(service.get("runs")[0]["error"], "stopped on request")

    def test_a_killed_service_puts_the_lens_back(self):
        service, events = self.service, Events(self.service)
        service.post("sweep", {"step": 1})
        events.wait("evaluated")
        service.process.send_signal(signal.SIGTERM)
        self.assertEqual(events.wait("ended")["status"], "stopped")
        self.assertEqual(events.wait("state")["lens"]["position"], 0)
        service.process.communicate(timeout=PATIENCE_S)
        self.assertEqual(service.process.returncode, 0)
        (run,) = (service.folder / "runs").glob("*-sweep-*.json")
        self.assertEqual(json.loads(run.read_text())["error"], "stopped on request")

    def test_one_drives_and_hands_over(self):
        service = self.service
        first, second = Events(service, "first"), Events(service, "second")
        for watcher in (first, second):
            watcher.wait("state")  # it hears what happens from here on
        self.assertEqual(service.post("lens", {"by": 5}, client="first")[0], 200)
        refused = service.post("lens", {"by": 5}, client="second")
        self.assertEqual((refused[0], refused[1]["error"]["code"]), (403, "not_driver"))
        service.post("drive", {"action": "ask"}, client="second")
        asked = first.wait("drive", lambda drive: drive["asking"] == ["second"])
        self.assertTrue(asked["you"])
        service.post("drive", {"action": "give"}, client="first")
        second.wait("drive", lambda drive: drive["you"])
        self.assertEqual(service.post("lens", {"by": 5}, client="second")[0], 200)

    def test_pictures(self):
        service = self.service
        status, headers, png = service.ask("GET", "/api/v1/frame")
        self.assertEqual((status, png[1:4], headers["X-Fathom-Position"]), (200, b"PNG", "0"))
        _, _, pgm = service.ask("GET", "/api/v1/frame?format=pgm")
        self.assertTrue(pgm.startswith(b"P5\n256 240\n255\n"))
        self.assertEqual(len(pgm), len(b"P5\n256 240\n255\n") + 256 * 240)
        connection = http.client.HTTPConnection("127.0.0.1", service.port, timeout=PATIENCE_S)
        connection.request("GET", "/api/v1/stream.mjpg?width=128&fps=50",
                           headers={"Authorization": f"Bearer {TOKEN}"})
        answer = connection.getresponse()
        stamps = []
        while len(stamps) < 5:
            line = answer.readline().decode("latin-1")
            if line.startswith("X-Fathom-Stamp-Ns"):
                stamps.append(int(line.split(": ")[1]))
        self.assertEqual(stamps, sorted(set(stamps)))
        connection.close()
        self.assertEqual(service.ask("GET", "/api/v1/stream.mjpg?fps=0")[0], 400)


class Elsewhere(unittest.TestCase):
    """Another program measures with the rig, over HTTP."""

    def setUp(self):
        self.service = Service("sim:target=seedling,distance=1800,noise=0,drift=0")
        self.addCleanup(lambda: self.service.process.poll() is None and self.service.end())
        self.home = tempfile.TemporaryDirectory()
        self.addCleanup(self.home.cleanup)

    def rig(self):
        return f"http://127.0.0.1:{self.service.port}"

    def begin(self, *arguments, token=TOKEN):
        environment = dict(os.environ, XDG_STATE_HOME=self.home.name, FATHOM_TOKEN=token)
        return subprocess.Popen([FATHOM, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, env=environment, cwd=self.home.name)

    def run_verb(self, *arguments, token=TOKEN):
        process = self.begin(*arguments, token=token)
        out, words = process.communicate(timeout=PATIENCE_S)
        return process.returncode, out, words

    def test_measures_as_at_the_rig_itself(self):
        near = "sim:target=seedling,distance=1800,noise=0,drift=0"
        travel = ("--from", "700", "--to", "860", "--step", "10")
        for arguments in (("sweep", *travel, "--json"), ("focus", "--json")):
            answers = []
            for rig in (near, self.rig()):
                status, out, words = self.run_verb(*arguments, "--rig", rig)
                self.assertEqual(status, 0, words)
                answers.append([(line["position"], line["score"]) for line in
                                map(json.loads, out.splitlines()) if "score" in line])
            self.assertGreater(len(answers[0]), 0)
            if arguments[0] == "sweep":  # a search sees frames on its way only at the rig itself
                self.assertEqual(*answers)
            else:
                self.assertAlmostEqual(answers[0][-1][0], answers[1][-1][0], delta=1.5)
        drive = self.service.get("state")["drive"]
        self.assertIsNone(drive["driver"], "it is given back")

    def test_watchers_see_its_frames_and_may_stop_it(self):
        events = Events(self.service, "page")
        process = self.begin("sweep", "--rig", self.rig(), "--step", "1")
        for _ in range(5):
            events.wait("score")
        self.assertEqual(self.service.post("lens", {"by": 1}, client="page")[1]["error"]["code"],
                         "not_driver")
        process.send_signal(signal.SIGINT)
        _, words = process.communicate(timeout=PATIENCE_S)
        self.assertIn("stopped on request", words)
        state = self.service.get("state")
        self.assertEqual(state["lens"]["position"], 0, "it went back")
        self.assertIsNone(state["drive"]["driver"])

    def test_words(self):
        status, _, words = self.run_verb("focus", "--rig", self.rig(), token="another-one")
        self.assertEqual(status, 1)
        self.assertIn("wants another token", words)
        self.service.post("lens", {"by": 1}, client="page")
        self.assertIn("somebody else drives", self.run_verb("focus", "--rig", self.rig())[2])

    def test_a_killed_service(self):
        events = Events(self.service, "page")
        process = self.begin("sweep", "--rig", self.rig(), "--step", "1")
        events.wait("score")
        self.service.process.kill()
        _, words = process.communicate(timeout=PATIENCE_S)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("fathom serve", words)
        self.service.process.communicate(timeout=PATIENCE_S)

    def test_a_service_that_hangs(self):
        events = Events(self.service, "page")
        process = self.begin("sweep", "--rig", self.rig() + ",timeout_s=0.5", "--step", "1")
        events.wait("score")
        self.service.process.send_signal(signal.SIGSTOP)
        _, words = process.communicate(timeout=PATIENCE_S)
        self.service.process.send_signal(signal.SIGCONT)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("does not answer", words)


class Showing(unittest.TestCase):
    def test_read_only(self):
        service = Service("sim", "--read-only")
        self.assertTrue(service.get("state")["read_only"])
        for path in ("focus", "stop", "lens", "drive", "windows"):
            self.assertEqual(service.post(path, {"by": 1})[1]["error"]["code"], "read_only", path)
        self.assertEqual(service.end(signal.SIGINT)[0], 0)

    def test_a_stuck_watcher_holds_nobody_up(self):
        """32 watch, one of them reads nothing: a sweep goes to its end, and the others see every
        evaluation of it and every score in its order."""
        service = Service("sim:target=seedling,distance=1800")
        stuck = [socket.create_connection(("127.0.0.1", service.port)) for _ in range(2)]
        for connection, path in zip(stuck, ("stream.mjpg", "events")):
            connection.sendall(f"GET /api/v1/{path}?token={TOKEN} HTTP/1.1\r\n"
                               f"Host: localhost\r\n\r\n".encode())
        watchers = [Events(service, f"w{i}") for i in range(31)]
        self.assertEqual(service.post("sweep", {"from": 600, "to": 900, "step": 10})[0], 202)
        seen = []
        for watcher in watchers:
            with watcher.condition:
                watcher.condition.wait_for(
                    lambda w=watcher: w.is_over or any(kind == "ended" for kind, _ in w.events),
                    PATIENCE_S)
                seen.append([(kind, data) for kind, data in watcher.events
                             if kind in ("evaluated", "ended")])
                stamps = [data["stamp_ns"] for kind, data in watcher.events if kind == "score"]
            self.assertEqual(stamps, sorted(set(stamps)))
        self.assertEqual([kind for kind, _ in seen[0]], ["evaluated"] * 31 + ["ended"])
        for other in seen[1:]:
            self.assertEqual(other, seen[0])
        for connection in stuck:
            connection.close()
        self.assertEqual(service.end()[0], 0)

    def test_wrong_usage(self):
        for options, words in ((["--token", "short"], "a token has 8"),
                               (["--port", "70000"], "0 to 65535"),
                               (["--search", "nosuch"], "nosuch"),
                               (["--bind", "nosuch.invalid"], "cannot listen")):
            done = subprocess.run([FATHOM, "serve", "--rig", "sim", *options], text=True,
                                  capture_output=True, timeout=PATIENCE_S,
                                  env=dict(os.environ, XDG_STATE_HOME="/tmp"))
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
