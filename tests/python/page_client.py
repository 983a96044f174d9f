"""A browser's end of the page's protocol, as far as tests need it: viewer/web/src/protocol.ts has the messages."""
import base64
import json
import os
import socket
import struct
import time
import typing
import urllib.parse

UPDATE = 2
SECONDS = 60


class Update(typing.NamedTuple):
    tick: int
    hash: int
    last: bool


class PageClient:
    def __init__(self, address, protocol="troupe"):
        url = urllib.parse.urlparse(address)
        self._socket = socket.create_connection((url.hostname, url.port), timeout=SECONDS)
        self._file = self._socket.makefile("rb")
        key = base64.b64encode(os.urandom(16)).decode()
        query = f"?{url.query}" if url.query else ""
        self._socket.sendall((f"GET /socket{query} HTTP/1.1\r\nHost: {url.netloc}\r\nUpgrade: websocket\r\n"
                              f"Origin: http://{url.netloc}\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
                              f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: {protocol}\r\n\r\n").encode())
        status = self._file.readline()
        if b" 101 " not in status:
            raise AssertionError(f"no WebSocket: {status}")
        while self._file.readline().strip():
            pass

    def __del__(self):
        self._file.close()
        self._socket.close()

    def read(self):
        """(opcode, bytes) of the next message."""
        whole = b""
        kind = 0
        while True:
            first, second = self._file.read(2)
            size = second & 127
            if size >= 126:
                size, = struct.unpack(">H" if size == 126 else ">Q", self._file.read(2 if size == 126 else 8))
            whole += self._file.read(size)
            kind = kind or first & 15
            if first & 128:
                return kind, whole

    def wait_for(self, tick=None, last=False):
        """The first update with that tick, or the last one of the run."""
        deadline = time.monotonic() + SECONDS
        while time.monotonic() < deadline:
            kind, message = self.read()
            if kind != 2 or message[0] != UPDATE:
                continue
            _, _, flags, at, digest = struct.unpack_from("<BIBQQ", message)
            update = Update(at, digest, flags & 2 != 0)
            if update.last if last else update.tick == tick:
                return update
        raise AssertionError(f"no update with tick {tick}")

    def send(self, message):
        data = json.dumps(message).encode()
        mask = os.urandom(4)
        header = struct.pack(">BBH", 129, 254, len(data))
        self._socket.sendall(header + mask + bytes(byte ^ mask[i % 4] for i, byte in enumerate(data)))

    def ask(self, request):
        """The reply to a request."""
        self.send({**request, "id": 7})
        while True:
            kind, message = self.read()
            if kind == 1:
                reply = json.loads(message)
                if reply.get("type") == "reply" and reply.get("id") == 7:
                    return reply
