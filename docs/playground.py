"""Writes docs/play.png, the picture of the page of `scenic-ref play`: it needs the extra play, selenium, and Chromium with its driver."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

PLACE = Path(__file__).with_name("play.png")
IDLE = "return !state.typing && !document.body.dataset.busy && document.querySelectorAll('#grid .card').length === 12"


def main() -> None:
    """Open the page and take its picture."""
    command = [sys.executable, "-m", "scenic_ref", "play", "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        options = webdriver.ChromeOptions()
        for argument in ("--headless=new", "--no-sandbox", "--window-size=1240,860", "--hide-scrollbars"):
            options.add_argument(argument)
        options.binary_location = shutil.which("chromium") or ""
        with webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver"))) as browser:
            browser.get(server.stdout.readline().strip())
            while not browser.execute_script(IDLE):
                time.sleep(0.1)
            browser.save_screenshot(str(PLACE))
        server.terminate()


if __name__ == "__main__":
    main()
