"""A headless Chromium that is driven through a pipe, by the DevTools protocol."""

import json
import os
import select
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

OPTIONS = (
    "--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars",
)  # fmt: skip


def find_browser() -> str | None:
    """Return the program, None without one."""
    names = ("chromium", "chromium-browser", "google-chrome")
    return next((x for x in map(shutil.which, names) if x), None)


class Browser:
    """One page in a browser of its own."""

    def __init__(self, program: str, profile: Path, timeout: float = 90.0) -> None:
        """Start the browser with its files in a folder."""
        self.timeout, self.number, self.rest = timeout, 0, b""
        self.requests: list[str] = []
        self.errors: list[str] = []
        # The browser reads from its descriptor 3 and writes to 4; sh knows one digit of them only.
        theirs_in, self.out = os.pipe()
        self.into, theirs_out = os.pipe()
        command = [program, *OPTIONS, f"--user-data-dir={profile}", "about:blank"]
        shell = ["bash", "-c", f'exec "$@" 3<&{theirs_in} 4>&{theirs_out}', "sh", *command]
        with (profile.parent / "log").open("wb") as log:
            self.process = subprocess.Popen(
                shell, pass_fds=(theirs_in, theirs_out), stdout=log, stderr=log
            )
        os.close(theirs_in)
        os.close(theirs_out)
        targets = self._send("Target.getTargets", None)["targetInfos"]
        page = next(x["targetId"] for x in targets if x["type"] == "page")
        attach = {"targetId": page, "flatten": True}
        self.session = self._send("Target.attachToTarget", None, **attach)["sessionId"]
        for domain in ("Page", "Runtime", "Network"):
            self.send(f"{domain}.enable")

    def close(self) -> None:
        """End the browser."""
        self.process.terminate()
        self.process.wait(20)
        os.close(self.out)
        os.close(self.into)

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command to the page and return its result."""
        return self._send(method, self.session, **parameters)

    def open(self, path: Path, width: int, height: int, *, phone: bool = False) -> None:
        """Open a page and wait until it is ready."""
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=height, deviceScaleFactor=1, mobile=phone,
        )  # fmt: skip
        self.send("Emulation.setTouchEmulationEnabled", enabled=phone)
        self.send("Page.navigate", url=path.as_uri())
        end = time.monotonic() + self.timeout
        while self.value("document.documentElement?.dataset?.ready ?? ''") != "yes":
            assert time.monotonic() < end, f"the page does not get ready: {self.errors}"
            time.sleep(0.1)

    def value(self, expression: str) -> Any:
        """Return the value of an expression of JavaScript, awaited."""
        result = self.send(
            "Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True
        )
        assert "exceptionDetails" not in result, result
        return result["result"].get("value")

    def click(self, x: float, y: float) -> None:
        """Press and release the button of the mouse."""
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.mouse(kind, x, y)
        self.settle()

    def mouse(self, kind: str, x: float, y: float) -> None:
        """Send one event of the mouse."""
        pressed = kind != "mouseMoved"
        self.send(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y,
            button="left" if pressed else "none", clickCount=int(pressed),
        )  # fmt: skip

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Move the mouse with its button pressed."""
        self.mouse("mousePressed", *start)
        for k in range(1, 9):
            x, y = (a + (b - a) * k / 8 for a, b in zip(start, end, strict=True))
            self.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, buttons=1)
            self.settle()
        self.mouse("mouseReleased", *end)
        self.settle()

    def tap(self, x: float, y: float) -> None:
        """Touch the screen with one finger."""
        self.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.settle()

    def settle(self) -> None:
        """Wait for two frames."""
        frame = "new Promise(f => requestAnimationFrame(() => requestAnimationFrame(() => f(1))))"
        self.value(frame)

    def _send(self, method: str, session: str | None, **parameters: Any) -> dict[str, Any]:
        self.number += 1
        message: dict[str, Any] = {"id": self.number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self.number:
                assert "error" not in answer, answer
                return answer["result"]
            self._note(answer)

    def _note(self, event: dict[str, Any]) -> None:
        """Keep what the page asks the network for, and what goes wrong in it."""
        if event.get("method") == "Network.requestWillBeSent":
            self.requests.append(event["params"]["request"]["url"])
        if event.get("method") == "Runtime.exceptionThrown":
            self.errors.append(str(event["params"]["exceptionDetails"])[:500])

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.into], [], [], self.timeout)
            assert ready, "the browser does not answer"
            part = os.read(self.into, 1 << 20)
            assert part, "the browser has ended"
            self.rest += part
        message, _, self.rest = self.rest.partition(b"\0")
        return json.loads(message)


@pytest.fixture
def browser(tmp_path: Path) -> Iterator[Browser]:
    """Start a browser; check at the end that it asked the network for nothing, without errors."""
    program = find_browser()
    if program is None:
        pytest.skip("there is no Chromium")
    with closing(Browser(program, tmp_path / "profile", timeout=300.0)) as found:
        found.send(
            "Network.emulateNetworkConditions",
            offline=True, latency=0, downloadThroughput=0, uploadThroughput=0,
        )  # fmt: skip
        yield found
        assert not found.errors
        assert all(url.startswith(("file:", "data:", "blob:")) for url in found.requests)
