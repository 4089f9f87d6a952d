"""The playground as a test meets it: its server in a process of its own, asked by HTTP, or by a browser that types and clicks."""

from __future__ import annotations

import http.client
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, NamedTuple
from urllib.parse import urlsplit

import pytest

Messages = list[dict[str, Any]]


class Response(NamedTuple):
    """The status of an answer, its headers in small letters, and its body."""

    status: int
    headers: dict[str, str]
    body: str


class Served(subprocess.Popen):
    """A server in a process group of its own, which is killed when the `with` is left."""

    stdout: IO[str]
    stderr: IO[str]

    def __init__(self, *options: str, cwd: Path) -> None:
        command = [sys.executable, "-m", "scenic_ref", "play", "--no-browser", "--port", "0", *options]
        super().__init__(command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.address = self.stdout.readline().strip()

    def __exit__(self, *of_exception: object) -> None:
        with suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        super().__exit__(*of_exception)  # type: ignore[arg-type]

    def request(self, method: str, path: str, body: bytes | None = None, headers: dict[str, str] | None = None) -> Response:
        """An answer of the server; `path` counts from the root."""
        parts = urlsplit(self.address)
        connection = http.client.HTTPConnection(str(parts.hostname), parts.port, timeout=100)
        try:
            connection.putrequest(method, path, skip_host="Host" in (headers or {}))
            for name, value in {"Content-Length": str(len(body or b"")), **(headers or {})}.items():
                connection.putheader(name, value)
            connection.endheaders(body)
            answer = connection.getresponse()
            return Response(answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read().decode())
        finally:
            connection.close()

    @property
    def path(self) -> str:
        """The path of the page, which is its token."""
        return urlsplit(self.address).path

    def ask(self, work: str, program: str, **more: object) -> Messages:
        """The messages of the answer to a piece of work."""
        body = json.dumps({"page": "test", "slot": work, "work": work, "program": program, **more}).encode()
        answer = self.request("POST", f"{self.path}work", body, {"Content-Type": "application/json"})
        assert answer.status == 200, answer.body
        return [json.loads(line) for line in answer.body.splitlines()]

    def only(self, work: str, program: str, kind: str, **more: object) -> dict[str, Any]:
        """The one message of a kind."""
        [found] = [m for m in self.ask(work, program, **more) if m["kind"] == kind]
        return found


Serve = Callable[..., Served]


@pytest.fixture
def serve(tmp_path: Path) -> Serve:
    """Starts a server in the directory of the test."""
    return lambda *options: Served(*options, cwd=tmp_path)


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server that the tests of a module share."""
    with Served("--limit-seconds", "60", cwd=tmp_path_factory.mktemp("served")) as found:
        yield found


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Headless Chromium, which saves what is downloaded in a folder of its own, `downloads`."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs the extra test")
    if shutil.which("chromedriver") is None or (found := shutil.which("chromium") or shutil.which("google-chrome")) is None:
        pytest.skip("this system has no Chromium with its driver (Debian: apt-get install chromium chromium-driver)")
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1400,1000"):
        options.add_argument(argument)
    options.binary_location = found
    folder = tmp_path_factory.mktemp("downloads")
    options.add_experimental_option("prefs", {"download.default_directory": str(folder), "download.prompt_for_download": False})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.chrome.service.Service(shutil.which("chromedriver")))
    driver.downloads = folder
    try:
        yield driver
    finally:
        driver.quit()


PATIENCE = 120
"""Seconds after which a page that waits for something is taken to be broken."""


class Page:
    """The page as a person uses it."""

    def __init__(self, driver: Any, served: Any) -> None:
        self.driver, self.served = driver, served

    def open(self, fragment: str = "") -> None:
        """Open it anew."""
        self.driver.get("about:blank")
        self.driver.get(self.served.address + fragment)
        self.settled()

    def element(self, name: str) -> Any:
        """An element by its id."""
        return self.driver.find_element("id", name)

    def text(self, name: str) -> str:
        """The text of an element, shown or not."""
        return self.driver.execute_script("return document.getElementById(arguments[0]).textContent", name)

    def type(self, text: str) -> None:
        """Replace the program by typing, key by key."""
        from selenium.webdriver import Keys

        area = self.element("program")
        area.click()
        area.send_keys(Keys.CONTROL + "a")
        area.send_keys(Keys.DELETE)
        area.send_keys(text)

    def put(self, text: str) -> None:
        """Replace the program as pasting does."""
        self.driver.execute_script(
            "const p = document.getElementById('program'); p.focus(); p.select(); document.execCommand('insertText', false, arguments[0]);", text
        )

    def program(self) -> str:
        """What the program is."""
        return self.driver.execute_script("return document.getElementById('program').value")

    def choose(self, name: str, value: str) -> None:
        """Choose from a list."""
        from selenium.webdriver.support.ui import Select

        options = [option.get_attribute("value") for option in self.element(name).find_elements("tag name", "option")]
        Select(self.element(name)).select_by_index(options.index(value))

    def tab(self, name: str) -> None:
        """Open a view by a click, and wait for what it shows."""
        self.element(f"tab-{name}").click()
        self.settled()

    def until(self, condition: Callable[[], object], what: str = "") -> None:
        """Wait until something is so."""
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, f"{what}: {self.text('status')}"
            time.sleep(0.03)

    def settled(self) -> None:
        """Wait until nothing is being typed, drawn or asked for."""
        idle = "return document.readyState === 'complete' && !state.typing && !document.body.dataset.busy && !document.querySelector('.stale')"
        self.until(lambda: self.driver.execute_script(idle), "settled")

    def typed(self, text: str) -> None:
        """Put a program there and wait for its scenes."""
        before = self.driver.execute_script("return state.version")
        self.put(text)
        self.until(lambda: self.driver.execute_script("return state.version") > before)
        self.settled()

    def scenes(self) -> list[str]:
        """What the pictures of the scenes say."""
        return self.driver.execute_script("return [...document.querySelectorAll('#grid svg.scene')].map(e => e.getAttribute('aria-label'))")

    def marked(self, kind: str) -> list[str]:
        """The parts of the program that are marked."""
        return self.driver.execute_script("return [...document.querySelectorAll(arguments[0])].map(e => e.textContent)", f"#marks .{kind}")

    def problems(self) -> list[str]:
        """What the console of the browser tells."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]


@pytest.fixture
def page(browser: Any, served: Any) -> Iterator[Page]:
    """The page, opened anew; the console must be silent at the end."""
    found = Page(browser, served)
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    found.open()
    found.problems()
    yield found
    assert found.problems() == []
