"""Servers on this machine that say whatever a test wants, byte by byte, and keep all that they are told."""

import socket
import threading
from contextlib import contextmanager, suppress

BEGINNING = b"HTTP/1.1 200 OK\r\nconnection: close\r\n"
ANSWER = (
    b'{"id":"0","object":"chat.completion","created":0,"model":"m","choices":[{"index":0,'
    b'"finish_reason":"%e","message":{"role":"assistant","content":"%s"}}],'
    b'"usage":{"prompt_tokens":9,"completion_tokens":3,"total_tokens":12}}'
)


class Rogue:
    """What a server was told, and where it is."""

    def __init__(self, port):
        self.port = port
        self.heard = b""
        """All bytes of all connections."""
        self.over = threading.Event()
        """Set when the test is done."""

    @property
    def address(self):
        return f"http://127.0.0.1:{self.port}/v1"


@contextmanager
def talking(say):
    """Serve with `say(rogue, connection, head)`, called once per request with its first line and headers."""
    listener = socket.create_server(("127.0.0.1", 0))
    rogue = Rogue(listener.getsockname()[1])

    def serve(connection):
        with connection, suppress(OSError):
            connection.settimeout(5)
            data = b""
            while b"\r\n\r\n" not in data:
                piece = connection.recv(65_536)
                if not piece:
                    return
                data += piece
                rogue.heard += piece
            head, _, body = data.partition(b"\r\n\r\n")
            wanted = 0
            for line in head.lower().splitlines():
                if line.startswith(b"content-length:"):
                    wanted = int(line.split(b":")[1])
            while len(body) < wanted:
                piece = connection.recv(65_536)
                body += piece
                rogue.heard += piece
            say(rogue, connection, head)

    def accept():
        while True:
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            threading.Thread(target=serve, args=(connection,), daemon=True).start()

    threading.Thread(target=accept, daemon=True).start()
    try:
        yield rogue
    finally:
        rogue.over.set()
        listener.shutdown(socket.SHUT_RDWR)
        listener.close()


def dripping(head, piece, pause_s=0.005):
    """Say `head`, and then `piece` again and again."""

    def say(rogue, connection, asked):
        connection.sendall(head)
        while not rogue.over.wait(pause_s):
            connection.sendall(piece)

    return say


def saying(data):
    """Say the same to everybody."""

    def say(rogue, connection, asked):
        connection.sendall(data)

    return say


def answering(text, status="200 OK", headers="", ending="stop"):
    """Give one answer in OpenAI's format; `text` as it stands between the quotes of its JSON."""
    body = ANSWER.replace(b"%s", text.encode()).replace(b"%e", ending.encode())
    head = f"HTTP/1.1 {status}\r\n{headers}connection: close\r\n"
    return saying(f"{head}content-length: {len(body)}\r\n\r\n".encode() + body)


def redirecting(target, status=307):
    """Redirect to an address, in which `{port}` is this server's."""
    head = f"HTTP/1.1 {status} Elsewhere\r\nlocation: {target}\r\nconnection: close\r\n\r\n"

    def say(rogue, connection, asked):
        connection.sendall(head.replace("{port}", str(rogue.port)).encode())

    return say
