"""moto's S3 server with the failures of a real one: 503 for some time, and slow reads. Requires `pip install 'moto[server]'`.

The answer is 503 to the first eight reads of a key that contains `busy`; to all reads of a key that contains `down`, until
the file `recovered` is in the folder of the second argument; and to one in forty of all other reads. A read of a key that
contains `slow` takes three seconds. The file `counts.json` in that folder counts reads, listings and answers of 503.
"""

from __future__ import annotations

import json
import random
import sys
import threading
import time
from collections import Counter
from pathlib import Path

from moto.server import DomainDispatcherApplication, create_backend_app
from werkzeug.serving import WSGIRequestHandler, run_simple

BUSY = b"<Error><Code>SlowDown</Code><Message>Please reduce your request rate.</Message></Error>"


class Troubled:
    """The server, behind a filter that fails some reads."""

    def __init__(self, folder: Path) -> None:
        self.app = DomainDispatcherApplication(create_backend_app)
        self.folder, self.lock, self.chance = folder, threading.Lock(), random.Random(1)
        self.reads: Counter[str] = Counter()
        self.counts: Counter[str] = Counter()

    def __call__(self, environ: dict, start_response):
        path, method = environ["PATH_INFO"], environ["REQUEST_METHOD"]
        is_read = method == "GET" and "/logs/" in path
        is_listing = method == "GET" and "list-type" in environ.get("QUERY_STRING", "")
        with self.lock:
            self.reads[path] += is_read
            count = self.reads[path]
            down = "down" in path and not (self.folder / "recovered").exists()
            busy = is_read and (down or ("busy" in path and count <= 8) or self.chance.random() < 1 / 40)
            self.counts.update({"503": int(busy), "reads": int(is_read), "listings": int(is_listing)})
            (self.folder / "counts.json").write_text(json.dumps(self.counts))
        if busy:
            start_response("503 Slow Down", [("Content-Type", "application/xml"), ("Content-Length", str(len(BUSY)))])
            return [BUSY]
        if is_read and "slow" in path:
            time.sleep(3)
        return self.app(environ, start_response)


class Quiet(WSGIRequestHandler):
    protocol_version = "HTTP/1.1"

    def log(self, *_: object) -> None:
        """Suppresses the log, because requests are counted."""


if __name__ == "__main__":
    run_simple("127.0.0.1", int(sys.argv[1]), Troubled(Path(sys.argv[2])), threaded=True, request_handler=Quiet)
