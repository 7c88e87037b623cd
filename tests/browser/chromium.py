"""Headless Chromium through the DevTools protocol, with nothing but Python's own library."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
import zlib

FLAGS = [
    "--headless=new", "--no-sandbox", "--no-first-run", "--disable-extensions", "--hide-scrollbars",
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe",
]


class Chromium:
    """A browser that reads commands from its file descriptor 3 and answers on 4, as JSON with a zero byte behind."""

    def __init__(self):
        names = ["chromium", "chromium-browser", "google-chrome"]
        program = next((path for path in map(shutil.which, names) if path), None)
        if program is None:
            raise SystemExit("no Chromium found; on Debian: apt-get install chromium")
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        (from_us, self.to), (self.answers, from_it) = os.pipe(), os.pipe()

        def connect():
            # Copies first: one of the pipes may itself be number 3 or 4.
            commands, replies = os.dup(from_us), os.dup(from_it)
            os.dup2(commands, 3)
            os.dup2(replies, 4)

        arguments = [program, *FLAGS, f"--user-data-dir={self.profile.name}", "about:blank"]
        self.process = subprocess.Popen(
            arguments, preexec_fn=connect, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        os.close(from_us)
        os.close(from_it)
        self.buffer, self.number, self.events = b"", 0, []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.profile.cleanup()

    def call(self, method, session=None, **parameters):
        """The result of a command; events that come meanwhile are kept."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def read(self):
        while b"\0" not in self.buffer:
            part = os.read(self.answers, 1 << 20)
            if not part:
                raise RuntimeError("the browser has gone")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def page(self, path, **settings):
        """Opens a file of the disk."""
        return Page(self, path, **settings)


class Page:
    """A page of a file, with what it says on its console and what it asks for."""

    def __init__(self, browser, path, width=1440, height=900, scheme="light", motion="reduce", fragment="", before=""):
        self.browser = browser
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.target = target
        self.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.media(scheme, motion)
        # A script that runs before those of the page.
        self.call("Page.addScriptToEvaluateOnNewDocument", source=before)
        self.address = "file://" + os.path.abspath(path)
        self.call("Page.navigate", url=self.address + fragment)
        is_drawn = "document.documentElement.dataset.ready === 'true' || document.getElementById('fault')?.hidden === false"
        self.wait(f"location.protocol === 'file:' && document.readyState === 'complete' && ({is_drawn})")

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def media(self, scheme, motion):
        features = [{"name": "prefers-color-scheme", "value": scheme}, {"name": "prefers-reduced-motion", "value": motion}]
        self.call("Emulation.setEmulatedMedia", features=features)

    def value(self, expression):
        """The value of an expression in the page."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"]["exception"].get("description", expression))
        return result["result"].get("value")

    def wait(self, expression, seconds=60):
        """Waits until an expression is true."""
        end = time.time() + seconds
        while not self.value(expression):
            if time.time() > end:
                raise AssertionError(f"{self.address}: not within {seconds} s: {expression}")
            time.sleep(0.05)

    def settle(self):
        """Waits until two pictures have been drawn."""
        self.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def press(self, key, code=None, text=None):
        """Presses a key."""
        number = {"ArrowLeft": 37, "ArrowRight": 39, "Home": 36, "End": 35, " ": 32, "Tab": 9}.get(key, 0)
        for kind in ["keyDown", "keyUp"]:
            extra = {"text": text} if text and kind == "keyDown" else {}
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=code or key, windowsVirtualKeyCode=number, **extra)
        self.settle()

    def drag(self, points):
        """Presses the mouse at the first point, moves over the others and lets go."""
        for i, (x, y) in enumerate(points):
            kind = "mousePressed" if i == 0 else "mouseMoved"
            if i == 0:
                self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)
        x, y = points[-1]
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left", clickCount=1)
        self.settle()

    def box(self, selector):
        """Left, top, width and height of an element."""
        return self.value(
            f"(r => [r.left, r.top, r.width, r.height])(document.querySelector({json.dumps(selector)}).getBoundingClientRect())"
        )

    def picture(self, selector=None):
        """A PNG of an element, or of all that is in sight."""
        clip = {}
        if selector:
            x, y, width, height = self.box(selector)
            left, top = self.value("[scrollX, scrollY]")
            clip = {"clip": {"x": x + left, "y": y + top, "width": width, "height": height, "scale": 1}}
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", **clip)["data"])

    def complaints(self):
        """What stands on the console, errors that nobody caught, and addresses outside the file."""
        found = []
        for event in self.browser.events:
            if event.get("sessionId") != self.session:
                continue
            method, parameters = event["method"], event["params"]
            if method == "Runtime.consoleAPICalled":
                found.append(" ".join(str(item.get("value", item.get("description"))) for item in parameters["args"]))
            elif method == "Runtime.exceptionThrown":
                found.append(str(parameters["exceptionDetails"].get("exception", {}).get("description")))
            elif method == "Log.entryAdded":
                found.append(parameters["entry"]["text"])
            elif method == "Network.requestWillBeSent":
                url = parameters["request"]["url"]
                if not url.startswith((self.address, "data:", "blob:", "about:")):
                    found.append(f"asks for {url}")
        return found

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)


def pixels(png):
    """Rows of an RGB or RGBA picture, as bytes, and the bytes of a pixel."""
    at, data = 8, b""
    while at < len(png):
        length, kind = int.from_bytes(png[at:at + 4], "big"), png[at + 4:at + 8]
        body = png[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, colour = int.from_bytes(body[:4], "big"), body[9]
        elif kind == b"IDAT":
            data += body
        at += 12 + length
    size = 4 if colour == 6 else 3
    raw, rows, last = zlib.decompress(data), [], bytearray(width * size)
    for start in range(0, len(raw), width * size + 1):
        row = bytearray(raw[start + 1:start + 1 + width * size])
        undo(raw[start], row, last, size)
        rows.append(bytes(row))
        last = row
    return rows, size


def undo(kind, row, above, size):
    """Takes a filter of PNG back."""
    for i in range(len(row)):
        left = row[i - size] if i >= size else 0
        up, corner = above[i], above[i - size] if i >= size else 0
        if kind == 1:
            add = left
        elif kind == 2:
            add = up
        elif kind == 3:
            add = (left + up) // 2
        elif kind == 4:
            guess = left + up - corner
            add = min((left, up, corner), key=lambda value: abs(guess - value))
        else:
            return
        row[i] = (row[i] + add) & 255


def colours(png):
    """Number of different colours of a picture."""
    rows, size = pixels(png)
    return len({row[i:i + 3] for row in rows for i in range(0, len(row), size)})
