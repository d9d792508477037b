"""The server of what is watched: on this machine only, from memory, with news as they come."""

from __future__ import annotations

import hashlib
import html
import json
import re
from collections.abc import Mapping
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Condition
from typing import Any
from urllib.parse import quote, unquote, urlsplit

from geotween.export.build import INDEX
from geotween.export.resources import resource

ADDRESS = "127.0.0.1"
SCRIPT, NEWS = "/geotween-watch.js", "/geotween-watch"
EMPTY = b"<!doctype html><title>geotween</title><body></body>"
HEARTBEAT = 10.0  # seconds after which a silent reader is written to, to see whether it is there
TYPES = {"html": "text/html; charset=utf-8", "svg": "image/svg+xml", "js": "text/javascript"}

_POLICY = re.compile(r'(<meta http-equiv="Content-Security-Policy" content=")([^"]*)')


class Shelf:
    """What is served: files by name, errors by page; readers wait for the next change.

    ``first`` is the page that comes up where none is named.
    """

    def __init__(self) -> None:
        self.first = INDEX
        self.files: Mapping[str, bytes] = {}
        self.errors: Mapping[str, str] = {}
        self.number = 0
        self.hosts: tuple[str, ...] = ()
        self.closed = False
        self._changed = Condition()

    def put(self, files: Mapping[str, bytes], errors: Mapping[str, str]) -> None:
        """Serve other files, and tell all readers."""
        with self._changed:
            self.files, self.errors, self.number = files, errors, self.number + 1
            self._changed.notify_all()

    def content(self, name: str) -> bytes | None:
        """A file; an empty page where there are errors only."""
        return self.files.get(name, EMPTY if name in self.errors else None)

    def close(self) -> None:
        """Let all readers go."""
        with self._changed:
            self.closed = True
            self._changed.notify_all()

    def news(self, page: str, seen: int) -> tuple[int, str | None]:
        """The number of the newest change, and what to tell a page; None after a silence."""
        with self._changed:
            self._changed.wait_for(lambda: self.closed or self.number != seen, HEARTBEAT)
            if self.number == seen:
                return seen, None
            found = version(self.content(page) or b"")
            return self.number, json.dumps({"version": found, "error": self.errors.get(page)})


def version(content: bytes) -> str:
    """The same for the same content, so that nothing is reloaded for nothing."""
    return hashlib.sha256(content).hexdigest()[:16]


def serve(shelf: Shelf, port: int) -> ThreadingHTTPServer:
    """A server of a shelf, not yet started; port 0 takes any that is free.

    Raises
    ------
    OSError
        Where the port is taken.
    """
    server = _Server((ADDRESS, port), partial(_Handler, shelf))
    shelf.hosts = tuple(f"{name}:{server.server_port}" for name in (ADDRESS, "localhost"))
    return server


class _Server(ThreadingHTTPServer):
    daemon_threads = True


class _Handler(BaseHTTPRequestHandler):
    server_version, sys_version = "geotween", ""

    def __init__(self, shelf: Shelf, *arguments: Any) -> None:
        self.shelf = shelf
        super().__init__(*arguments)

    def do_GET(self) -> None:
        # Another name that leads here is a foreign page's way to read along (DNS rebinding).
        if self.headers.get("Host") not in self.shelf.hosts:
            self.send_error(HTTPStatus.MISDIRECTED_REQUEST)
            return
        address = urlsplit(self.path)
        name = unquote(address.path).removeprefix("/")
        content = self.shelf.content(name)
        if address.path == NEWS:
            self._news(unquote(address.query))
        elif address.path == SCRIPT:
            self._send((resource("templates") / "watch.js").read_bytes(), TYPES["js"])
        elif not name:
            self._moved(self.shelf.first)
        elif content is not None:
            kind = name.rpartition(".")[2]
            served = followed(content, name) if kind == "html" else content
            self._send(served, TYPES.get(kind, "application/octet-stream"))
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def _send(self, content: bytes, kind: str) -> None:
        self.send_response(HTTPStatus.OK)
        self._headers(kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def _moved(self, page: str) -> None:
        self.send_response(HTTPStatus.FOUND)
        self.send_header("Location", "/" + quote(page))
        self.send_header("Content-Length", "0")
        self.end_headers()

    def _news(self, page: str) -> None:
        """Tell a page of changes, as server-sent events, until one of both goes."""
        self.send_response(HTTPStatus.OK)
        self._headers("text/event-stream")
        self.end_headers()
        seen = 0
        try:
            while not self.shelf.closed:
                seen, told = self.shelf.news(page, seen)
                self.wfile.write(b": still here\n\n" if told is None else _event(told))
                self.wfile.flush()
        except OSError:  # the page was closed
            return

    def _headers(self, kind: str) -> None:
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")

    def log_message(self, *_: object) -> None:
        """Requests are nobody's concern."""


def followed(page: bytes, name: str) -> bytes:
    """A page that follows what is built: with a script, and a policy that admits it."""
    text = _POLICY.sub(lambda found: found[1] + _admitting(found[2]), page.decode(), count=1)
    told = f'data-page="{html.escape(name)}" data-version="{version(page)}"'
    script = f'<script src="{SCRIPT}" {told}></script>\n'
    body, end, rest = text.rpartition("</body>")
    return (f"{body}{script}{end}{rest}" if end else text + script).encode()


def _admitting(policy: str) -> str:
    rules = dict.fromkeys(filter(None, map(str.strip, html.unescape(policy).split(";"))))
    known = {rule.split()[0]: rule for rule in rules}
    for name in ("script-src", "connect-src"):
        known[name] = known.get(name, name) + " 'self'"
    return html.escape("; ".join(known.values()))


def _event(told: str) -> bytes:
    return f"data: {told}\n\n".encode()
