"""A headless Chromium for tests of a page: opens it, sends real keys and mouse moves, and reads what the page shows.

It speaks the DevTools protocol over two pipes (JSON messages that end with a zero byte), so it needs nothing but the
standard library and a `chromium` on the PATH.
"""

import fcntl
import json
import os
import select
import shutil
import signal
import tempfile
import time

EXECUTABLE = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
TIMEOUT = 30    # seconds; an answer takes milliseconds, the start of the browser seconds

# Keys that are not letters: name of the physical key, and its number.
KEYS = {" ": ("Space", 32), "End": ("End", 35), "Home": ("Home", 36), "ArrowLeft": ("ArrowLeft", 37),
        "ArrowUp": ("ArrowUp", 38), "ArrowRight": ("ArrowRight", 39), "ArrowDown": ("ArrowDown", 40)}


def pipe():
    """Both ends of a pipe, away from the low descriptors that the browser is given."""
    ends = os.pipe()
    moved = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in ends]
    for end in ends:
        os.close(end)
    return moved


class Browser:
    def __init__(self):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        read_commands, self.commands = pipe()
        self.answers, write_answers = pipe()
        # It reads commands from descriptor 3 and answers to 4; subprocess cannot place descriptors, posix_spawn can.
        self.process = os.posix_spawn(
            EXECUTABLE, [EXECUTABLE, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
                         "--remote-debugging-pipe", "--force-color-profile=srgb", "--window-size=1200,1000",
                         f"--user-data-dir={self.profile.name}", "about:blank"], os.environ, setsid=True,
            file_actions=[(os.POSIX_SPAWN_DUP2, read_commands, 3), (os.POSIX_SPAWN_DUP2, write_answers, 4),
                          *((os.POSIX_SPAWN_OPEN, standard, os.devnull, os.O_RDWR, 0) for standard in range(3))])
        os.close(read_commands)
        os.close(write_answers)
        self.received = b""
        self.last_id = 0
        self.session = None
        self.events = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")

    def close(self):
        self.session = None
        try:
            self.call("Browser.close")
        except (OSError, RuntimeError):
            pass    # it has ended already, or it hangs and is killed below
        deadline = time.monotonic() + TIMEOUT
        while not os.waitpid(self.process, os.WNOHANG)[0]:
            if time.monotonic() > deadline:
                os.killpg(self.process, signal.SIGKILL)
            time.sleep(0.02)
        os.close(self.commands)
        os.close(self.answers)
        self.profile.cleanup()

    def call(self, method, **parameters):
        """The answer to a command; events that come before it are kept in `events`."""
        self.last_id += 1
        message = {"id": self.last_id, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        rest = json.dumps(message).encode() + b"\0"
        while rest:
            rest = rest[os.write(self.commands, rest):]
        while True:
            answer = self.next_message()
            if answer.get("id") != self.last_id:
                self.events.append(answer)
            elif "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']}")
            else:
                return answer["result"]

    def next_message(self):
        deadline = time.monotonic() + TIMEOUT
        while b"\0" not in self.received:
            if not select.select([self.answers], [], [], max(0, deadline - time.monotonic()))[0]:
                raise RuntimeError(f"{EXECUTABLE} does not answer")
            part = os.read(self.answers, 1 << 20)
            if not part:
                raise RuntimeError(f"{EXECUTABLE} ended")
            self.received += part
        message, _, self.received = self.received.partition(b"\0")
        return json.loads(message)

    def open(self, file):
        """Loads a page and waits for its end; `events` are those of this page from then on."""
        self.call("Page.navigate", url="about:blank")
        self.events = []
        failed = self.call("Page.navigate", url=file.resolve().as_uri()).get("errorText")
        if failed:
            raise RuntimeError(f"{file}: {failed}")
        self.wait_for("document.readyState === 'complete' && location.protocol === 'file:'")

    def value(self, expression):
        """What a JavaScript expression gives in the page."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait_for(self, expression):
        deadline = time.monotonic() + TIMEOUT
        while not self.value(expression):
            if time.monotonic() > deadline:
                raise RuntimeError(f"never true: {expression}")
            time.sleep(0.02)

    def complaints(self):
        """Errors and exceptions of the page, and its requests to anywhere but its own file and data."""
        self.value("0")
        found = []
        for event in self.events:
            parameters = event.get("params", {})
            if event["method"] == "Runtime.exceptionThrown":
                found.append(parameters["exceptionDetails"])
            elif event["method"] == "Runtime.consoleAPICalled" and parameters["type"] in ["error", "warning", "assert"]:
                found.append(parameters["args"])
            elif event["method"] == "Log.entryAdded" and parameters["entry"]["level"] in ["error", "warning"]:
                found.append(parameters["entry"])
            elif event["method"] == "Network.requestWillBeSent":
                address = parameters["request"]["url"]
                if not address.startswith(("file:", "data:", "about:")):
                    found.append(address)
        return found

    def press(self, key, shift=False):
        code, number = KEYS.get(key) or (f"{'Digit' if key.isdigit() else 'Key'}{key.upper()}", ord(key.upper()))
        key_settings = {"key": key, "code": code, "windowsVirtualKeyCode": number, "modifiers": 8 if shift else 0}
        text = {"text": key} if len(key) == 1 else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", **key_settings, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", **key_settings)

    def move(self, x, y):
        self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def place(self, selector, across=0.5, down=0.5):
        """Where in the window an element is, after scrolling to it."""
        return self.value(f"""(() => {{
            const shown = document.querySelector({json.dumps(selector)});
            shown.scrollIntoView({{block: "nearest", behavior: "instant"}});
            const box = shown.getBoundingClientRect();
            return [box.left + {across} * box.width, box.top + {down} * box.height];
        }})()""")

    def move_over(self, selector, across=0.5, down=0.5):
        self.move(*self.place(selector, across, down))

    def turn_wheel(self, selector, steps, across=0.5, down=0.5):
        """Towards the reader by that many notches."""
        x, y = self.place(selector, across, down)
        self.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=100 * steps)

    def click(self, selector):
        x, y = self.place(selector)
        self.move(x, y)
        for kind in ["mousePressed", "mouseReleased"]:
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def focus(self, selector):
        self.value(f"document.querySelector({json.dumps(selector)}).focus()")
