"""Runs programs and measures them. No process that is started here outlives its call."""
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

from run_processes import descendants, memory

TIME_LIMIT = 300  # s, of any one program


class Failure(Exception):
    pass


class Usage:
    """The cost of a program with all its child processes."""

    def __init__(self):
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.wall = time.monotonic()
        self.user = used.ru_utime
        self.system = used.ru_stime
        self.switches = used.ru_nvcsw + used.ru_nivcsw
        self.bytes = self._loopback_bytes()

    @staticmethod
    def _loopback_bytes():
        with open("/proc/net/dev") as file:
            for line in file:
                if line.strip().startswith("lo:"):
                    return int(line.split()[9])
        return 0

    def since(self, before):
        return {key: value - getattr(before, key) for key, value in vars(self).items()}


def run(command, limit=TIME_LIMIT, environment=None):
    """The program's output and its resource usage."""
    before = Usage()
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               start_new_session=True, env={**os.environ, **(environment or {})})
    try:
        output, errors = process.communicate(timeout=limit)
    except BaseException as failure:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        if isinstance(failure, subprocess.TimeoutExpired):
            raise Failure(f"{' '.join(map(str, command))}: not done after {limit} s") from None
        raise
    if process.returncode != 0:
        raise Failure(f"{' '.join(map(str, command))}: status {process.returncode}\n{errors[-2000:]}")
    return output, Usage().since(before)


class Troupe:
    """The programs of a build."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    def has(self, program):
        return (self.folder / program).exists()

    def run(self, world, ticks, *options, headless=True):
        """The summary of a run, with its resource usage under "usage"."""
        with tempfile.NamedTemporaryFile(suffix=".json") as summary:
            _, usage = run([self.folder / "troupe", "run", world, "--ticks", ticks, "--speed", "max",
                            *(["--headless"] if headless else []), "--summary", summary.name, *options])
            return {**json.load(open(summary.name)), "usage": usage}

    def per_robot_and_tick(self, world, ticks, *options, headless=True):
        """The cost of a tick: that of a long run minus that of a short one, which is the cost of start and end."""
        begin = time.monotonic()
        short = self.run(world, 2, *options, headless=headless)
        short_seconds = time.monotonic() - begin
        long = self.run(world, ticks, *options, headless=headless)
        of_tick = {key: (long["usage"][key] - short["usage"][key]) / (ticks - 2) for key in long["usage"]}
        share = 1e6 / long["robots"]
        return {
            "robots": long["robots"],
            "processes": long["processes"],
            "ticks": ticks,
            "wall_us": long["wall_seconds"] / long["ticks"] * share,
            "user_us": of_tick["user"] * share,
            "system_us": of_tick["system"] * share,
            "switches": of_tick["switches"] / long["robots"],
            "bytes_per_tick": of_tick["bytes"],
            "real_time_factor": long["real_time_factor"],
            "short_seconds": short_seconds,  # with start and end
            "startup_seconds": long["startup_seconds"],
            "service_mib": long["service_peak_memory_mib"],
            "agent_mib": long["agent_peak_memory_mib"],
            "frames_repeated": long["frames_repeated"],
            "state_hash": long["state_hash"],
        }

    def memory(self, world, ticks, *options):
        """MiB of the processes of a run after so many ticks; pages that several of them share count for each in equal
        parts, so that the sum is what all need."""
        session = f"bench-memory-{os.getpid()}"
        launcher = subprocess.Popen([str(word) for word in [
            self.folder / "troupe", "run", world, "--speed", "max", "--headless", "--paused", "--session", session,
            *options]], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
        try:
            run([self.folder / "troupe", "ctl", "step", ticks, "--session", session, "--timeout", TIME_LIMIT])
            found = [(program, memory(pid)) for pid, program in descendants(launcher.pid)]
            launcher.send_signal(signal.SIGINT)
            launcher.communicate(timeout=TIME_LIMIT)
        except BaseException:
            launcher.kill()
            launcher.communicate()
            raise
        agents = [of_agent for program, of_agent in found if program == "robot-agent"]
        service = next(of_service for program, of_service in found if program == "world-service")
        mean = {f"agent_{key}_mib": sum(of_agent[key] for of_agent in agents) / len(agents) for key in service}
        return {"agents": len(agents), **mean, "service_share_mib": service["share"],
                "together_mib": service["share"] + sum(of_agent["share"] for of_agent in agents)}

    def with_door_requests(self, world, ticks, *options, requests):
        """The summary of a run of a world with a door, with the number of `requests` that another program has made of it
        ten times a second, or none."""
        session, domain = f"bench-door-{os.getpid()}", 78
        options = [*options, "--session", session, "--domain", domain]
        if not requests:
            return {**self.run(world, ticks, *options), "requests": 0}
        client = subprocess.Popen([self.folder / "door_requests", session, str(domain)], stdout=subprocess.PIPE, text=True)
        try:
            summary = self.run(world, ticks, *options)
            output, _ = client.communicate(timeout=TIME_LIMIT)
        except BaseException:
            client.kill()
            client.communicate()
            raise
        return {**summary, **json.loads(output)}

    def test(self, test, *options):
        """The usage of a session of tests."""
        return run([self.folder / "troupe", "test", test, *options])[1]

    def check(self, world):
        return run([self.folder / "troupe", "check", world])

    def json_line(self, program, *arguments):
        output, _ = run([self.folder / program, *arguments])
        return json.loads(output)

    def functions(self, program, rounds, quick, environment):
        """Rows of a Google Benchmark program, one for each round."""
        # "0.2" and not "0.2s": version 1.7 accepts a number only.
        command = [self.folder / program, "--benchmark_format=json", f"--benchmark_min_time={0.01 if quick else 0.2}",
                   f"--benchmark_repetitions={rounds}"]
        if quick:
            command.append("--benchmark_filter=-/(10000|200000)")
        output, _ = run(command, environment=environment)
        return [row for row in json.loads(output)["benchmarks"]
                if row.get("run_type") == "iteration" and not row.get("error_occurred")]


class Stage:
    def __init__(self, program):
        self.program = pathlib.Path(program).absolute()

    def seconds(self, world):
        """Wall time of a whole run. Stage's threads sometimes miss their start; then it never ends."""
        environment = {"LD_LIBRARY_PATH": f"{self.program.parent.parent}/lib:{os.environ.get('LD_LIBRARY_PATH', '')}"}
        for attempt in range(3):
            try:
                _, usage = run([self.program, "-g", world], limit=180, environment=environment)
                return usage["wall"], usage["user"] + usage["system"]
            except Failure as failure:
                print(f"Stage, attempt {attempt + 1}: {failure}", file=sys.stderr)
        raise Failure("Stage did not end in three attempts")

    def per_robot_and_tick(self, world_of, robots, ticks, interval=0.1):
        """world_of(seconds) gives the world that ends after so many simulated seconds."""
        short_wall, short_processor = self.seconds(world_of(2 * interval))
        long_wall, long_processor = self.seconds(world_of(ticks * interval))
        share = 1e6 / robots / (ticks - 2)
        wall = long_wall - short_wall
        return {"robots": robots, "processes": 1, "ticks": ticks, "wall_us": wall * share,
                "user_us": (long_processor - short_processor) * share,
                "real_time_factor": (ticks - 2) * interval / wall, "startup_seconds": short_wall}
