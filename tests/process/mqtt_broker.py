"""A broker of MQTT on loopback for tests: Debian's mosquitto, on a free port, and the programs that listen to it."""
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

SECONDS = 60  # longest time to an answer on the slowest machine


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


class Broker:
    """`tls`: a folder with ca.crt, server.crt and server.key."""
    def __init__(self, folder, tls=None, port=None):
        self.program = shutil.which("mosquitto", path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")
        if self.program is None:
            raise SystemExit("error: found no mosquitto (Debian's package mosquitto)")
        self.port = port or free_port()
        self.configuration = pathlib.Path(folder) / f"mosquitto-{self.port}.conf"
        lines = [f"listener {self.port} 127.0.0.1", "allow_anonymous true", "set_tcp_nodelay true", "max_queued_messages 100000"]
        if os.getuid() == 0:
            lines.append("user root")
        if tls:
            lines += [f"cafile {tls}/ca.crt", f"certfile {tls}/server.crt", f"keyfile {tls}/server.key"]
        self.configuration.write_text("\n".join(lines) + "\n")
        self.scheme = "mqtts" if tls else "mqtt"
        self.process = None
        self.start()

    @property
    def url(self):
        return f"{self.scheme}://127.0.0.1:{self.port}"

    def start(self):
        self.process = subprocess.Popen([self.program, "-c", self.configuration], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        until = time.monotonic() + SECONDS
        while time.monotonic() < until:
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
                return
            except OSError:
                if self.process.poll() is not None:
                    raise SystemExit(f"error: mosquitto ended with {self.process.returncode}") from None
                time.sleep(0.02)
        raise SystemExit("error: mosquitto does not listen")

    def stop(self):
        self.process.terminate()
        self.process.wait(SECONDS)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()


class Listener:
    """A program that prints lines until it is interrupted."""
    def __init__(self, *command):
        self.process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                        errors="replace")
        self.lines = []

    def wait_for(self, part):
        """The next line with this part."""
        for line in self.process.stdout:
            self.lines.append(line.rstrip("\n"))
            if part in line:
                return self.lines[-1]
        raise AssertionError(f"found no line with '{part}' before the end, which was {self.process.wait()}: {self.lines}")

    def finish(self, interrupt=True):
        """The exit status, and all lines."""
        if interrupt:
            self.process.send_signal(signal.SIGINT)
        self.lines += self.process.communicate(timeout=SECONDS)[0].splitlines()
        return self.process.returncode, self.lines

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
