import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import textwrap
import unittest

import troupe
from support import PROGRAMS, ROOT, interrupted, logged, run

SEEK = """
import math

class Seek:
    accepts_goals = True

    def __init__(self, robot, speed=0.4, patience=10):
        self.ranger = robot.sensor("ranger")
        self.speed, self.patience = speed, patience
        self.past = []          # memory in a list and a dict
        self.turns = {"left": 0, "right": 0}

    def subscriptions(self):
        return [self.ranger]

    def update(self, seen):
        reading = seen.sensors[self.ranger]
        nearest = min(float(scan.ranges.min()) for scan in reading.scans) if reading else 9.0
        self.past.append(nearest)
        if nearest < 0.6 or seen.stalled:
            side = "left" if seen.random(0) < 0.5 + 0.01 * (self.turns["right"] - self.turns["left"]) else "right"
            self.turns[side] += 1
            return 0.0, 0.9 if side == "left" else -0.9
        return self.speed, 0.1 * math.sin(sum(self.past[-self.patience:]))
"""


def agents_of(pid):
    """The processes of robots that the process has started."""
    with open(f"/proc/{pid}/task/{pid}/children") as file:
        children = [int(child) for child in file.read().split()]
    return [child for child in children if b"robot-agent" in pathlib.Path(f"/proc/{child}/cmdline").read_bytes()]


class Controllers(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(textwrap.dedent(text))

    def scenario(self, controller, parameters=None, robots=4, name="run.json", **settings):
        content = {"name": "python_controllers", "world": str(ROOT / "worlds/office.world"), "ticks": 60, "seed": 7,
                   "speed": "max", "spawn": [{"model": "scout", "count": robots, "region": [-12, -8, 12, 8],
                                              "spacing": 0.6, "heading": "random", "name_prefix": "s",
                                              "controller": {"name": controller, "parameters": parameters or {}}}]}
        content.update(settings)
        self.write(name, json.dumps(content))
        return self.path(name)

    def test_hashes_are_equal_in_one_process_and_in_agents(self):
        self.write("seek.py", SEEK)
        scenario = self.scenario("./seek.py:Seek", {"speed": 0.5})
        sim = troupe.Simulation(scenario)
        self.assertEqual(sim.robot(0).parameters, {"speed": 0.5})
        own = {}
        for _ in range(60):
            sim.step()
            own[sim.tick] = sim.state_hash
        self.assertEqual(sim.failures, [])
        self.assertTrue((sim.poses != troupe.Simulation(scenario).poses).any())
        for arguments in (["--in-process"], ["--robots-per-process", 3], ["--robots-per-process", 1]):
            found = logged(scenario, self.folder.name, *arguments)
            for tick, digest in own.items():
                self.assertEqual(found[tick], digest, f"{arguments} tick {tick}")

    def test_agents_that_are_killed_and_rewound_change_no_hash(self):
        self.write("seek.py", SEEK)
        scenario = self.scenario("./seek.py:Seek", {"speed": 0.5})
        expected = logged(scenario, self.folder.name, "--in-process")
        session = f"python-rebuild-{os.getpid()}"
        command = [PROGRAMS / "troupe", "run", scenario, "--headless", "--robots-per-process", "2", "--paused",
                   "--on-agent-loss", "rebuild", "--lease", "1", "--hash-log", self.path("killed"), "--session", session]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
            lines = []

            def await_line(text):
                for line in process.stdout:
                    lines.append(line)
                    if text in line:
                        return
                self.fail("".join(lines))

            def control(*words):
                done = subprocess.run([PROGRAMS / "troupe", "ctl", *words, "--session", session], capture_output=True,
                                      text=True, timeout=60)
                self.assertEqual(done.returncode, 0, done.stderr + "".join(lines))

            await_line("ready")
            control("step", "25")
            os.kill(agents_of(process.pid)[0], signal.SIGKILL)
            await_line("restart ")
            control("step", "10")  # of the rebuilt robots
            control("rewind", "12")
            control("play")
            lines += process.stdout
            self.assertEqual(process.wait(timeout=60), 0, "".join(lines))
        with open(self.path("killed")) as file:
            found = [(int(tick), int(digest, 16)) for tick, digest in map(str.split, file)]
        self.assertEqual([tick for tick, _ in found], [*range(36), *range(12, 61)])
        self.assertEqual([digest for _, digest in found], [expected[tick] for tick, _ in found])

    def test_the_option_of_the_command_line_names_a_class(self):
        self.write("seek.py", SEEK)
        scenario = self.scenario("idle")
        with open(scenario) as file:
            content = json.load(file)
        del content["spawn"][0]["controller"]
        self.write("run.json", json.dumps(content))
        sim = troupe.Simulation(scenario, controller=self.path("seek.py") + ":Seek")
        sim.step(60)
        for arguments in (["--in-process"], []):
            found = logged(scenario, self.folder.name, "--controller", self.path("seek.py") + ":Seek", *arguments)
            self.assertEqual(found[60], sim.state_hash)

    def test_snapshots_copy_the_memory(self):
        self.write("seek.py", SEEK)
        sim = troupe.Simulation(self.scenario("./seek.py:Seek"))
        sim.step(20)
        saved = sim.save()
        sim.step(30)
        expected = sim.state_hash
        for _ in range(2):
            sim.restore(saved)
            sim.step(30)
            self.assertEqual(sim.state_hash, expected)
        fork = troupe.Simulation(self.scenario("./seek.py:Seek"))
        fork.restore(saved)
        fork.step(30)
        self.assertEqual(fork.state_hash, expected)

    def test_vectorised_hashes_are_equal(self):
        self.write("seek.py", SEEK)
        scenario = self.scenario("./seek.py:Seek")
        vector = troupe.VectorSimulation(scenario, 3, threads=2)
        vector.step(20)
        for i in range(3):
            sim = troupe.Simulation(scenario, seed=7 + i)
            sim.step(20)
            self.assertEqual(sim.state_hash, int(vector.state_hashes[i]))

    def test_a_failure_names_the_line_and_the_run_goes_on(self):
        self.write("bad.py", """
            class Bad:
                def __init__(self, robot):
                    self.name = robot.name
                def update(self, seen):
                    if seen.tick == 5 and self.name == "s0":
                        return self.divide(seen.tick)
                    return 0.3, 0.0
                def divide(self, x):
                    return x / 0
            """)
        scenario = self.scenario("./bad.py:Bad")
        sim = troupe.Simulation(scenario)
        sim.step(30)
        self.assertEqual(len(sim.failures), 1)
        self.assertIn("failed at tick 5: bad.py:10: ZeroDivisionError: division by zero", sim.failures[0])
        self.assertFalse(sim.twists[0].any())
        self.assertTrue(sim.twists[1:].any())
        done = run(scenario, "--ticks", 30)
        self.assertIn("bad.py:10: ZeroDivisionError", done.stdout + done.stderr)

    def test_wrong_commands_are_failures(self):
        for i, command in enumerate(["'fast'", "(1,)", "(1, 2, 3, 4)", "('a', 'b')", "object()", "float('nan')",
                                     "(float('nan'), object())", "Command(vx='x')", "Command(grippers=[1])",
                                     "Command(joints=[JointCommand(9, 1.0)])", "Command(report=5)", "{1: 2}",
                                     "Command(messages=[RadioMessage(99, b'x')])", "Command(orders=[LightOrder(7, True)])", "Command(orders=[WaitOrder(99999)])", "Command(orders=[5])",
                                     "(_ for _ in ()).throw(SystemExit(3))", "(_ for _ in ()).throw(KeyboardInterrupt())"]):
            name = f"wrong{i}.py"
            self.write(name, f"""
                from troupe.controller import *
                class Wrong:
                    def __init__(self, robot): pass
                    def update(self, seen): return {command}
                """)
            sim = troupe.Simulation(self.scenario(f"./{name}:Wrong", robots=1))
            sim.step(3)
            self.assertEqual(len(sim.failures), 1, command)

    def test_faults_of_a_class_are_errors_of_the_start(self):
        self.write("faults.py", """
            class NoRanger:
                def __init__(self, robot):
                    robot.sensor("sonar:77")
                def update(self, seen): pass
            class Subscribes:
                subscriptions = [99]
                def __init__(self, robot): pass
                def update(self, seen): pass
            class NoUpdate:
                pass
            """)
        self.write("syntax.py", "class Patrol:\n    def update(self seen): pass\n")
        for controller, parameters, text in [
                ("faults.py:NoRanger", {}, "faults.py:4: ValueError: robot s0 has no sensor 'sonar:77'"),
                ("faults.py:Subscribes", {}, "subscribes to sensor 99"),
                ("faults.py:NoUpdate", {}, "no class NoUpdate with a method 'update', found: NoRanger, Subscribes"),
                ("faults.py:Missing", {}, "no class Missing"), ("faults.py", {}, "expected FILE.py:CLASS"),
                ("faults.py:Subscribes", {"sped": 1}, "unexpected keyword argument 'sped'"),
                ("syntax.py:Patrol", {}, "syntax.py:2: SyntaxError"), ("none.py:Patrol", {}, "no such file")]:
            with self.assertRaises(troupe.Error) as caught:
                troupe.Simulation(self.scenario("./" + controller, parameters))
            self.assertIn(text, str(caught.exception))

    def test_reports_texts_and_tuples(self):
        self.write("talk.py", """
            from troupe.controller import Command, Controller
            class Talk(Controller):
                def update(self, seen):
                    return Command(vx=0.1, report=f"tick {seen.tick}", say="hello" if seen.tick == 1 else "")
            """)
        sim = troupe.Simulation(self.scenario("./talk.py:Talk", robots=1))
        sim.step(3)
        self.assertEqual(sim.reports, [f"robot s0: tick {i}" for i in range(3)])
        self.assertIn(("said", "hello"), [(event.type, event.detail) for event in sim.events])

    def test_says_what_it_waits_for(self):
        self.write("wait.py", """
            from troupe.controller import Command, Controller, WaitOrder
            class Wait(Controller):
                def __init__(self, robot): self.first = robot.id == 0
                def update(self, seen):
                    waits = self.first and 3 <= seen.tick < 20
                    return Command(orders=[WaitOrder(thing=1)] if waits else [])
            """)
        sim = troupe.Simulation(self.scenario("./wait.py:Wait", robots=2))
        sim.step(10)
        self.assertEqual(sim.failures, [])
        waits = sim.table("waits")
        self.assertEqual([list(waits[column]) for column in ("robot", "since")], [["s0"], [4]])
        robots = sim.table("robots")
        self.assertEqual(list(robots["blocked_by"]), [waits["thing"][0], ""])
        self.assertAlmostEqual(robots["wait_time"][0], 6 * sim.interval)
        sim.step(11)
        self.assertEqual(len(sim.table("waits")["robot"]), 0)

    def test_random_numbers_are_those_of_cpp(self):
        self.write("draw.py", """
            class Draw:
                def __init__(self, robot): pass
                def update(self, seen):
                    assert 0.0 <= seen.random(3) < 1.0 and seen.random(3) == seen.random(3) != seen.random(4)
                    return seen.random(0), seen.random(1)
            """)
        one, two = (troupe.Simulation(self.scenario("./draw.py:Draw"), seed=seed) for seed in (1, 2))
        one.step(5), two.step(5)
        self.assertEqual(one.failures, [])
        self.assertTrue((one.twists != two.twists).any())

    def test_a_controller_cannot_call_its_own_simulation(self):
        self.write("reach.py", """
            import gc, troupe
            class Reach:
                def __init__(self, robot): pass
                def update(self, seen):
                    for each in gc.get_objects():
                        if isinstance(each, list) and len(each) == 1 and isinstance(each[0], troupe.Simulation):
                            each[0].step()
            """)
        holder = [troupe.Simulation(self.scenario("./reach.py:Reach", robots=1))]
        holder[0].step(2)
        self.assertIn("in use", holder[0].failures[0])

    def test_a_robot_that_cannot_be_copied_has_no_snapshot(self):
        self.write("lock.py", """
            import threading
            class Lock:
                def __init__(self, robot): self.lock = threading.Lock()
                def update(self, seen): return 0.1, 0.0
            """)
        sim = troupe.Simulation(self.scenario("./lock.py:Lock", robots=1))
        sim.step()
        with self.assertRaises(troupe.RunError):
            sim.save()
        sim.step()

    def test_a_changed_file_is_read_again(self):
        for speed in (0.1, 0.25):
            self.write("edit.py", f"class Edit:\n    def __init__(self, robot): pass\n"
                                  f"    def update(self, seen): return {speed}, 0\n")
            sim = troupe.Simulation(self.scenario("./edit.py:Edit", robots=1))
            sim.step(5)  # before the robot comes to an obstacle
            self.assertEqual(sim.failures, [])
            self.assertAlmostEqual(sim.twists[0, 0], speed)

    def test_ctrl_c_stops_the_run_and_no_robot(self):
        self.write("seek.py", SEEK)
        code = f"s = troupe.Simulation({self.scenario('./seek.py:Seek')!r})\n" \
               "try:\n print('on', flush=True); s.step(10**9)\n" \
               "except KeyboardInterrupt:\n s.step(1); print('stopped', s.failures)"
        self.assertEqual(interrupted(self, code)[0], "stopped []\n")

    def two_folders(self):
        for folder, speed in (("A", 0.1), ("B", 0.3)):
            os.mkdir(self.path(folder))
            os.mkdir(self.path(f"{folder}/parts"))
            self.write(f"{folder}/common.py", f"V = {speed}\n")
            self.write(f"{folder}/parts/__init__.py", "from .wheel import turn\nimport common\n")
            self.write(f"{folder}/parts/wheel.py", f"def turn():\n    import common\n    return common.V - {speed}\n")
            self.write(f"{folder}/c.py", """
                import common, parts.wheel
                class C:
                    def __init__(self, robot): pass
                    def update(self, seen):
                        from parts import turn
                        import common as later
                        return (common.V if later is common else 9.0), turn() + parts.wheel.turn()
                """)
        regions = {"A": [-12, -8, 0, 8], "B": [1, -8, 12, 8]}
        return self.scenario("", spawn=[
            {"model": "scout", "count": 2, "region": region, "name_prefix": name.lower(), "controller": {"name": f"./{name}/c.py:C"}}
            for name, region in regions.items()])

    @staticmethod
    def speeds(sim):
        """Of the robots that no wall stops."""
        return {round(speed, 3) for speed in sim.twists[:, 0] if speed}

    def test_folders_may_have_modules_of_one_name(self):
        scenario = self.two_folders()
        sim = troupe.Simulation(scenario)
        sim.step(3)
        self.assertEqual(sim.failures, [])
        self.assertEqual(self.speeds(sim), {0.1, 0.3})
        sim.step(57)
        for arguments in (["--in-process"], ["--robots-per-process", 1]):
            self.assertEqual(logged(scenario, self.folder.name, *arguments)[60], sim.state_hash, arguments)
        self.assertNotIn("common", sys.modules)

    def test_a_module_beside_a_controller_is_loaded_again_after_a_change(self):
        scenario = self.two_folders()
        troupe.Simulation(scenario).step(3)
        self.write("A/common.py", "V = 0.25  # m/s\n")
        sim = troupe.Simulation(scenario)
        sim.step(3)
        self.assertEqual(self.speeds(sim), {0.25, 0.3})

    def test_an_error_names_the_line_of_the_module_beside_it(self):
        self.write("helper.py", "def half(x):\n    return x / 0\n")
        self.write("c.py", """
            import helper
            class C:
                def __init__(self, robot): pass
                def update(self, seen): return helper.half(1), 0
            """)
        sim = troupe.Simulation(self.scenario("./c.py:C", robots=1))
        sim.step(1)
        self.assertIn("helper.py:2: ZeroDivisionError", sim.failures[0])
        self.write("c.py", "import helper, nonesuch_module\nclass C:\n    def update(self, seen): return None\n")
        with self.assertRaisesRegex(troupe.Error, "c.py:1: ModuleNotFoundError: No module named 'nonesuch_module'"):
            troupe.Simulation(self.scenario("./c.py:C", robots=1))

    def test_ctrl_c_ends_a_loop_in_a_controller(self):
        self.write("loop.py", """
            class Loop:
                def __init__(self, robot): pass
                def update(self, seen):
                    if seen.tick == 3:
                        print("on", flush=True)
                        while True: pass
            """)
        code = f"s = troupe.Simulation({self.scenario('./loop.py:Loop', robots=1)!r})\n" \
               "try:\n s.step(10)\n" \
               "except KeyboardInterrupt:\n print('stopped', s.failures)"
        self.assertRegex(interrupted(self, code)[0], r"stopped \['.*loop.py:\d+: KeyboardInterrupt'\]")


if __name__ == "__main__":
    unittest.main()
