"""A headless Chromium, spoken to through the pipe of its own DevTools protocol: no driver, no network."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from base64 import b64decode
from pathlib import Path
from typing import Any, Self

__all__ = ["BROWSER", "Browser", "Seen"]

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None
)
"""The program, or None where there is no browser."""

OPTIONS = (
    "--headless", "--no-sandbox", "--remote-debugging-pipe", "--disable-gpu", "--disable-dev-shm-usage",
    "--no-first-run", "--disable-extensions", "--disable-background-networking", "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)  # fmt: skip
ON_3_AND_4 = """
import os, sys
ours = [os.dup(os.dup(os.dup(int(number)))) for number in sys.argv[1:3]]  # clear of 3 and 4
for number, place in zip(ours, (3, 4)):
    os.dup2(number, place)
os.execv(sys.argv[3], sys.argv[3:])
"""
"""The protocol is spoken on file descriptors 3 and 4 of the browser."""

PATIENCE_S = 60


class Seen:
    """What happened while a page was loaded."""

    def __init__(self) -> None:
        self.complaints: list[str] = []
        """Console messages, logged errors and uncaught exceptions."""
        self.requests: list[str] = []
        """Everything that was asked for, the page itself included; data: URIs are the page's own."""


class Browser:
    """One page of a browser. Use it as a context manager."""

    def __init__(self) -> None:
        assert BROWSER is not None, "skipped elsewhere"
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_it, ours = os.pipe()
        theirs, from_it = os.pipe()
        pipes = [sys.executable, "-c", ON_3_AND_4, str(to_it), str(from_it)]
        self._process = subprocess.Popen(
            [*pipes, BROWSER, *OPTIONS, f"--user-data-dir={self._profile.name}", "about:blank"],
            pass_fds=(to_it, from_it), stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(to_it)
        os.close(from_it)
        self._out, self._in = os.fdopen(ours, "wb", buffering=0), os.fdopen(theirs, "rb", buffering=0)
        self._rest, self._last, self._session = b"", 0, ""
        self._seen, self._loaded = Seen(), False
        try:
            self._begin()
        except BaseException:
            self._process.kill()
            self.close()
            raise

    def _begin(self) -> None:
        targets = self._ask("Target.getTargets")["targetInfos"]
        target = next(one["targetId"] for one in targets if one["type"] == "page")
        self._session = self._ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._ask(f"{domain}.enable")

    def load(self, path: Path, *, width: int, height: int = 800) -> Seen:
        """Load a file as a phone or a window of that width sees it."""
        self._ask(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=height, deviceScaleFactor=1, mobile=width < 600,
        )  # fmt: skip
        self._seen, self._loaded = Seen(), False
        self._ask("Page.navigate", url=path.absolute().as_uri())
        while not self._loaded:
            self._heard(self._read())
        self.run("document.fonts.ready.then(() => 1)")
        return self._seen

    def run(self, script: str) -> Any:
        """The value of an expression in the page."""
        answer = self._ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def picture(self, path: Path) -> None:
        """The whole page as a PNG."""
        answer = self._ask("Page.captureScreenshot", captureBeyondViewport=True)
        path.write_bytes(b64decode(answer["data"]))

    def close(self) -> None:
        """End it."""
        self._out.close()
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._in.close()
        self._profile.cleanup()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._last += 1
        message: dict[str, Any] = {"id": self._last, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        self._out.write(json.dumps(message).encode() + b"\0")
        while True:
            found = self._read()
            if found.get("id") == self._last:
                assert "error" not in found, found
                return found["result"]
            self._heard(found)

    def _read(self) -> dict[str, Any]:
        end = time.monotonic() + PATIENCE_S
        while b"\0" not in self._rest:
            more = os.read(self._in.fileno(), 1 << 16)
            if not more:
                raise RuntimeError(f"the browser ended with {self._process.wait()}")
            self._rest += more
            assert time.monotonic() < end, "the browser does not answer"
        message, _, self._rest = self._rest.partition(b"\0")
        return json.loads(message)

    def _heard(self, event: dict[str, Any]) -> None:
        method, told = event.get("method"), event.get("params", {})
        if method == "Page.loadEventFired":
            self._loaded = True
        elif method == "Network.requestWillBeSent":
            self._seen.requests.append(told["request"]["url"])
        elif method == "Runtime.consoleAPICalled":
            self._seen.complaints.append(str(told["args"]))
        elif method == "Runtime.exceptionThrown":
            self._seen.complaints.append(str(told["exceptionDetails"]))
        elif method == "Log.entryAdded":
            self._seen.complaints.append(told["entry"]["text"])
