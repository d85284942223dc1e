"""Two processes that `llm.py` starts: a server of known latency, and a study through a faulty one.

python benchmarks/_served.py slow SECONDS
python benchmarks/_served.py study OUT LOG FAULTS KILL_AFTER
"""

import hashlib
import json
import os
import random
import signal
import sys
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

CONCURRENCY = 16
FAULTS = (
    "http429 http500 http503 reset slow slow_head truncated wrong_schema malformed html empty huge "
    "cut"
).split()


def slow(seconds: float) -> None:
    """Answer every chat request after a fixed delay; print the port first."""
    text = json.dumps({"text": "A grand piano lies across the ego vehicle's lane."})
    document = json.dumps(
        {
            "id": "0",
            "object": "chat.completion",
            "created": 0,
            "model": "m",
            "choices": [
                {
                    "index": 0,
                    "finish_reason": "stop",
                    "message": {"role": "assistant", "content": text},
                }
            ],
            "usage": {"prompt_tokens": 100, "completion_tokens": 20, "total_tokens": 120},
        }
    ).encode()

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_POST(self) -> None:
            self.rfile.read(int(self.headers["content-length"]))
            time.sleep(seconds)
            self.send_response(200)
            self.send_header("content-type", "application/json")
            self.send_header("content-length", str(len(document)))
            self.end_headers()
            self.wfile.write(document)

        def log_message(self, *args: object) -> None:
            """Suppress the log."""

    class Server(ThreadingHTTPServer):
        request_queue_size = 128

    server = Server(("127.0.0.1", 0), Handler)
    print(server.server_port, flush=True)
    server.serve_forever()


def study(out: Path, log: Path, faults: float, kill_after: int) -> None:
    """Run the text pipeline through a server in this process.

    Args:
        out: Folder of the study.
        log: File that gets a line per request that arrives.
        faults: Fraction of the requests that fail.
        kill_after: Number of requests after which this process kills itself, at a random moment; 0 is never.
    """
    from oodscen import StudyConfig, make_llm
    from oodscen._pipeline import run_study
    from oodscen.llm._remote.limits import Limits
    from oodscen.testing import AnsweringServer

    config = StudyConfig(
        simulator="flat", encoder="hash", seed=3, llm="served", max_paths=13, sets=(10,)
    )
    draw = random.Random(5)

    def spoil(index: int, request: object) -> str | None:
        return draw.choice(FAULTS) if draw.random() < faults else None

    with AnsweringServer(make_llm("builtin", seed=3), faults=spoil) as server:
        record = server.record

        def recorded(received):
            asked = json.dumps([received.messages, received.body.get("seed")])
            with log.open("a") as file:
                file.write(hashlib.sha256(asked.encode()).hexdigest() + "\n")
            index = record(received)
            if kill_after and index + 1 == kill_after:
                wait = random.Random(kill_after).uniform(0.0, 0.1)
                threading.Timer(wait, os.kill, (os.getpid(), signal.SIGKILL)).start()
            return index

        server.record = recorded
        limits = Limits(concurrency=CONCURRENCY, strikes=1_000)
        timeout = 1.0 if faults else 60.0
        llm = server.client(seed=3, limits=limits, timeout_s=timeout, max_bytes=2_000_000)
        run_study(out, config, models={"served": llm}, limits=limits)


if __name__ == "__main__":
    if sys.argv[1] == "slow":
        slow(float(sys.argv[2]))
    else:
        study(Path(sys.argv[2]), Path(sys.argv[3]), float(sys.argv[4]), int(sys.argv[5]))
