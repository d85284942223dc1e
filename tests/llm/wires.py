"""Servers on this machine that speak other wire formats than OpenAI's, as their documentation has it."""

import base64
import json
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


def _anthropic(body):
    system = body.get("system", "")
    texts = [system] if isinstance(system, str) else [part["text"] for part in system]
    images = []
    for message in body["messages"]:
        for part in _parts(message["content"]):
            if part["type"] == "text":
                texts.append(part["text"])
            elif part["type"] == "image":
                assert part["source"]["type"] == "base64"
                images.append(base64.b64decode(part["source"]["data"], validate=True))
    return texts, images


def _gemini(body):
    turns = [*([body["system_instruction"]] if "system_instruction" in body else [])]
    texts, images = [], []
    for turn in [*turns, *body["contents"]]:
        for part in turn["parts"]:
            if "text" in part:
                texts.append(part["text"])
            elif "inline_data" in part:
                images.append(base64.b64decode(part["inline_data"]["data"], validate=True))
    return texts, images


def _ollama(body):
    texts = [message["content"] for message in body["messages"]]
    images = [
        base64.b64decode(image, validate=True)
        for message in body["messages"]
        for image in message.get("images") or ()
    ]
    return texts, images


def _parts(content):
    return [{"type": "text", "text": content}] if isinstance(content, str) else content


def _anthropic_answer(text, tool):
    content = [{"type": "text", "text": text}]
    if tool:
        content = [{"type": "tool_use", "id": "t", "name": tool, "input": json.loads(text)}]
    return {
        "id": "msg_0",
        "type": "message",
        "role": "assistant",
        "model": "claude",
        "content": content,
        "stop_reason": "tool_use" if tool else "end_turn",
        "stop_sequence": None,
        "usage": {"input_tokens": 120, "output_tokens": 30},
    }


def _gemini_answer(text, tool):
    return {
        "candidates": [
            {
                "content": {"role": "model", "parts": [{"text": text}]},
                "finishReason": "STOP",
                "index": 0,
            }
        ],
        "usageMetadata": {
            "promptTokenCount": 120,
            "candidatesTokenCount": 30,
            "totalTokenCount": 150,
        },
        "modelVersion": "gemini",
    }


def _ollama_answer(text, tool):
    return {
        "model": "llama3",
        "created_at": "2026-01-01T00:00:00Z",
        "message": {"role": "assistant", "content": text},
        "done": True,
        "done_reason": "stop",
        "prompt_eval_count": 120,
        "eval_count": 30,
    }


WIRES = {
    "anthropic": (_anthropic, _anthropic_answer, "/v1/messages", "x-api-key"),
    "gemini": (_gemini, _gemini_answer, ":generateContent", "x-goog-api-key"),
    "ollama_chat": (_ollama, _ollama_answer, "/api/chat", "authorization"),
}


class Wire:
    """What a server got, and how it is reached."""

    def __init__(self, address):
        self.address = address
        self.seen = []
        """(path, body, texts, images) per request for an answer."""
        self.keys = []


@contextmanager
def serving(provider, answer, status=lambda index: 200):
    """Serve one provider's format; `answer` maps the texts and images of a request to a text."""
    read, write, path, header = WIRES[provider]

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            body = json.loads(self.rfile.read(int(self.headers["content-length"])))
            if path not in self.path:
                return self.send(404, {"error": {"message": f"no {self.path}"}})
            texts, images = read(body)
            wire.seen.append((self.path, body, texts, images))
            wire.keys.append(self.headers.get(header) or "")
            code = status(len(wire.seen) - 1)
            if code != 200:
                return self.send(code, {"error": {"type": "overloaded", "message": "busy"}})
            tool = (body.get("tool_choice") or {}).get("name")
            return self.send(200, write(answer(texts, images), tool))

        def send(self, code, document):
            data = json.dumps(document).encode()
            self.send_response(code)
            self.send_header("content-type", "application/json")
            self.send_header("content-length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *args):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    wire = Wire(f"http://127.0.0.1:{server.server_port}")
    threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
    try:
        yield wire
    finally:
        server.shutdown()
        server.server_close()
