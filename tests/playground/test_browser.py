"""The page of the playground in headless Chromium, with real typing and clicks."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import pytest
import scenic_ref
from scenic_ref.playground.share_links import Linked, link_of, linked_of

from .conftest import Page

pytestmark = [pytest.mark.extra("play"), pytest.mark.slow]
EXAMPLES = Path(scenic_ref.__file__).parent / "examples"


def test_scenes_are_drawn_as_one_types(page: Page):
    page.type("ego = Object at (0, 0)\nother = Object at (Range(3, 4), 7)")
    page.until(lambda: "typing" in page.text("status") or "drawing" in page.text("status") or page.scenes())
    page.settled()
    assert page.program() == "ego = Object at (0, 0)\nother = Object at (Range(3, 4), 7)"
    scenes = page.scenes()
    assert len(scenes) == 12
    expected = scenic_ref.loads(page.program()).sample(0, 0).objects[1].position
    assert f"other (Object, object 1) at ({expected.x:.6g}, {expected.y:.6g})" in scenes[0]
    page.element("program").send_keys("\nthird = Object at (-4, 7)")
    page.until(lambda: "third" in "".join(page.scenes()))
    page.settled()
    assert len(page.scenes()) == 12


def test_no_scene_of_an_older_program_is_shown_with_a_newer_one(page: Page):
    page.typed("ego = Object at (0, 0)\nolder = Object at (2, 2)\n")
    assert "older" in page.scenes()[0]
    page.put("ego = Object at (0, 0)\nnewer = Object at (2, 2)\nnosuch\n")
    assert page.driver.execute_script("return document.getElementById('grid').classList.contains('stale')")
    page.settled()
    assert page.scenes() == []
    assert "nosuch" in page.text("message")


def test_the_slider_changes_the_seed(page: Page):
    from selenium.webdriver import Keys

    page.typed("ego = Object at (Range(0, 9), 0)\n")
    before = page.scenes()
    page.element("slider").send_keys(Keys.ARROW_RIGHT)
    page.settled()
    after = page.scenes()
    assert page.element("seed").get_attribute("value") == "1"
    assert before != after
    assert "of seed 1" in after[0]
    page.element("seed").clear()
    page.element("seed").send_keys("-3")
    page.until(lambda: "of seed -3" in "".join(page.scenes()))
    page.settled()
    page.choose("count", "4")
    page.settled()
    assert len(page.scenes()) == 4


def test_what_rejects_is_told_in_the_view_and_in_the_margin(page: Page):
    page.typed("x = Range(0, 1)\nego = Object at (0, 0)\nrequire x > 0.8\nrequire x < 0.9\n")
    page.tab("rejections")
    rows = [row.text for row in page.driver.find_elements("css selector", "#tally tbody tr")]
    assert "line 3" in rows[0]
    assert "line 4" in rows[1]
    badges = [badge.text for badge in page.driver.find_elements("css selector", "#gutter b")]
    assert len(badges) == 2
    page.driver.find_element("css selector", "#tally .link").click()
    assert page.driver.execute_script("return program.value.slice(program.selectionStart, program.selectionEnd)") == "require x > 0.8"


def test_a_histogram_of_a_property_has_the_exact_law_beside_it(page: Page):
    page.typed("x = Uniform(1, 2, 3)\nego = Object at (0, 0)\nother = Object at (5 * x, 5)\nrequire x < 3\nparam x = x\n")
    page.tab("histogram")
    page.choose("feature", "params.x")
    page.settled()
    rows = [row.text.split() for row in page.driver.find_elements("css selector", "#chart tbody tr")]
    assert [(row[0], row[-3]) for row in rows] == [("1", "1/2"), ("2", "1/2")]
    assert sum(int(row[1]) for row in rows) == 1000
    assert "accepted with probability 2/3" in page.text("chart")
    assert len(page.driver.find_elements("css selector", "#chart line.law")) == 2
    page.element("expression").send_keys("other.position.x > 5\n")
    page.settled()
    rows = [row.text.split() for row in page.driver.find_elements("css selector", "#chart tbody tr")]
    assert sorted((row[0], row[-3]) for row in rows) == [("False", "1/2"), ("True", "1/2")]
    page.element("expression").clear()
    page.element("expression").send_keys("Range(0, 1)\n")
    page.settled()
    assert "cannot draw" in page.text("histogram-message")


def test_a_histogram_of_many_values_is_binned_and_has_no_law(page: Page):
    page.typed("ego = Object at (0, 0)\nother = Object at (Range(3, 9), 5)\n")
    page.tab("histogram")
    page.choose("feature", "distance(0, 1)")
    page.settled()
    assert len(page.driver.find_elements("css selector", "#chart rect.bar")) == 24
    assert "infinitely many" in page.text("chart")
    assert "in m" in [text.text for text in page.driver.find_elements("css selector", "#chart svg text")]


def test_names_lie_on_no_other_object(page: Page):
    page.typed("ego = Object at (0, 0), with width 3, with length 2\nObject at (0, -2.3), with width 3, with length 2\n")
    boxes = "return ['.label:not(.mark)', '.thing'].map(kind => [...document.querySelectorAll(`#grid .card:first-child ${kind}`)].map(e => "
    names, things = page.driver.execute_script(boxes + "{const b = e.getBBox(); return [b.x, b.y, b.x + b.width, b.y + b.height]}))")
    assert len(names) >= 3 and len(things) >= 2
    assert not [(a, b) for a in names for b in things if a[0] < b[2] and b[0] < a[2] and a[1] + 2 < b[3] and b[1] < a[3] - 2]


def test_a_trace_is_stepped_through_and_its_rules_are_marked_in_the_program(page: Page):
    from selenium.webdriver import Keys

    page.typed("x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 0.5\n")
    page.driver.find_elements("css selector", "#grid .card")[0].click()
    page.driver.find_element("xpath", "//*[@id='detail']//button[text()='Trace it']").click()
    page.settled()
    assert page.marked("now") == ["Range(0, 1)"]
    assert "E-Distributions" in page.text("rule")
    first = page.text("where")
    page.element("forth").click()
    assert page.text("where") != first
    assert page.marked("now") == ["x = Range(0, 1)"]
    assert "σ(x)" in page.text("state")
    page.element("last").click()
    assert "all default requirements hold" in page.text("rule")
    page.element("last").send_keys(Keys.HOME)
    assert page.text("where") == first
    shown = len(page.driver.find_elements("css selector", "#events button"))
    page.element("inherited").click()
    assert len(page.driver.find_elements("css selector", "#events button")) > shown


def test_a_rejected_attempt_is_explained(page: Page):
    page.typed("x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 0.9\n")
    index = next(k for k in range(12) if scenic_ref.loads(page.program()).sample(0, k).attempts > 1)
    page.driver.find_elements("css selector", "#grid .card")[index].click()
    page.driver.find_element("xpath", "//*[@id='detail']//button[contains(text(), 'rejected')]").click()
    page.settled()
    assert "stuck: the run is discarded" in page.text("trace-message")
    page.element("last").click()
    assert page.marked("now") == ["require x > 0.9"]
    assert "does not hold" in page.text("rule")


def test_a_reading_is_switched_and_what_it_changes_is_shown_beside_the_default(page: Page):
    page.typed("x = Range(0, 1)\nego = Object at (0, 0)\nother = Object at (10 * x, 5)\nrequire[0.5] x < 0.1\n")
    page.tab("readings")
    page.element("survey").click()
    page.settled()
    assert "soft" in page.text("reading-message")
    page.element("find").send_keys("coin")
    page.choose("reading-soft", "scene")
    page.settled()
    assert "soft=scene, beside soft=run" in page.text("compared")
    pairs = page.driver.find_elements("css selector", "#compared .pair")
    changed = page.driver.find_elements("css selector", "#compared .pair.changed")
    assert len(pairs) == 12
    program = page.program()
    ours = [scenic_ref.loads(program, readings={"soft": answer}) for answer in ("run", "scene")]
    differ = sum(a.sample(0, k).objects != b.sample(0, k).objects for a, b in [ours] for k in range(12))
    assert len(changed) == differ > 0
    assert page.text("switched") == "1"
    page.element("reset").click()
    page.settled()
    assert page.text("compared") == ""


def test_a_dynamic_program_is_played(page: Page):
    page.typed((EXAMPLES / "dynamic" / "stop_in_time.scenic").read_text())
    page.tab("replay")
    assert "terminated" in page.text("replay-message")
    assert "step 0 of" in page.text("clock")
    page.element("play").click()
    page.until(lambda: int(page.text("clock").split()[1]) > 5)
    assert page.text("play") == "Pause"
    assert "StopInTime" in page.text("side")
    page.element("play").click()
    at = page.text("clock")
    time.sleep(0.3)
    assert page.text("clock") == at
    page.tab("trace")
    page.element("trace-steps").clear()
    page.element("trace-steps").send_keys("2\t")
    page.settled()
    assert "time step 1" in page.text("events")


def test_a_program_is_kept_in_a_link_with_its_seed_and_readings(page: Page):
    page.typed("ego = Object at (Range(0, 9), 1)  # ‼ 𝔘\n")
    page.element("seed").clear()
    page.element("seed").send_keys("42")
    page.tab("readings")
    page.choose("reading-soft", "scene")
    page.settled()
    page.element("export").click()
    page.element("copy-link").click()
    page.until(lambda: page.element("link").get_attribute("value"))
    link = page.element("link").get_attribute("value")
    assert page.served.path.strip("/") not in link
    assert linked_of(link) == Linked(page.program(), 42, {"soft": "scene"})
    scenes = page.scenes()
    page.open()
    assert page.program() != linked_of(link).program
    page.driver.get(link)  # without the token: the browser that had it knows the way
    page.until(lambda: page.driver.current_url.startswith(page.served.address))
    page.settled()
    assert (page.program(), page.element("seed").get_attribute("value")) == (linked_of(link).program, "42")
    assert page.scenes() == scenes
    page.problems()  # the answer without the token has the status 403


def test_a_link_is_pasted_and_the_command_line_takes_it(page: Page, serve: Any):
    link = link_of(Linked("ego = Object at (5, 6)\n", 3, {"soft": "scene", "nosuch": "x"}))
    page.element("export").click()
    page.element("open-link").send_keys(f"http://127.0.0.1:1/#{link}\n")
    page.until(lambda: "at (5, 6)" in "".join(page.scenes()))
    assert page.text("switched") == "1"
    with serve(f"http://127.0.0.1:1/#{link}") as server:
        given = json.loads(server.request("GET", server.path).body.split('id="given">')[1].split("</script>")[0])
        assert (given["program"], given["seed"], given["linked"]) == ("ego = Object at (5, 6)\n", 3, {"soft": "scene", "nosuch": "x"})


@pytest.mark.parametrize("fragment", ["#scenic1=AAAA", "#scenic1=", "#scenic1=%3Cscript%3E"])
def test_a_broken_link_is_told_so(page: Page, fragment: str):
    page.open(fragment)
    assert len(page.scenes()) == 12 or "holds no program" in page.text("message")
    page.element("export").click()
    page.element("open-link").send_keys(f"{fragment}\n")
    page.until(lambda: "holds no program" in page.text("exported"))


def test_program_and_pictures_are_exported(page: Page):
    page.typed("ego = Object at (0, 0)\nother = Object at (3, 3)\n")
    page.choose("count", "1")
    page.settled()
    for button, name, begins in (
        ("save-program", "program.scenic", b"ego = Object"), ("save-png", "program.png", b"\x89PNG"), ("save-svg", "program.svg", b"<?xml"),
    ):  # fmt: skip
        page.element("export").click() if not page.element("exports").is_displayed() else None
        page.element(button).click()
        saved: Path = page.driver.downloads / name
        page.until(lambda saved=saved: saved.exists() and saved.stat().st_size)
        assert saved.read_bytes().startswith(begins)


def test_both_pictures_are_saved_though_asked_for_at_once(page: Page):
    page.typed("ego = Object at (0, 0)\nother = Object at (3, 3)\n")
    page.settled()
    page.driver.execute_script("window.saved = []; window.save = (data, type, name) => window.saved.push(name)")
    page.driver.execute_script("document.getElementById('save-png').click(); document.getElementById('save-svg').click()")
    page.until(lambda: sorted(page.driver.execute_script("return window.saved")) == ["program.png", "program.svg"])


def test_angles_of_a_scene_are_in_both_units_and_its_columns_are_wide_enough(page: Page):
    page.typed("ego = Object at (0, 0), facing 90 deg\n")
    page.settled()
    page.driver.find_element("css selector", "#grid .card").click()
    assert "1.571 rad (90°)" in page.text("detail") or "1.5708 rad (90°)" in page.text("detail")
    widths = page.driver.execute_script("return [...document.querySelectorAll('#detail tbody tr:first-child td')].map(d => d.clientWidth)")
    assert widths[0] > 50 and widths[2] > 100


def test_an_expression_is_forgotten_with_its_program(page: Page):
    page.typed("ego = Object at (0, 0)\nother = Object at (3, 3)\n")
    page.tab("histogram")
    page.element("expression").send_keys("distance from ego to other\n")
    page.settled()
    page.choose("examples", "1")
    assert page.element("expression").get_attribute("value") == ""


HOSTILE = """</script><script>document.title='run'</script>"""
HOSTILE += """<img src=x onerror="document.title='run'">' " ` ${document.title='run'} &lt;b&gt; \u2028 \u202e"""


def test_texts_of_programs_are_texts(page: Page):
    text = repr(HOSTILE)
    page.typed(f"ego = Object at (0, 0), with note {text}\nparam p = {text}\nprint({text})\nrequire[0.9] ego.position.x == 0\n")
    assert len(page.scenes()) == 12
    page.driver.find_elements("css selector", "#grid .card")[0].click()
    assert "onerror" in page.text("detail")
    for name in ("rejections", "histogram", "trace", "readings", "replay"):
        page.tab(name)
    page.tab("histogram")
    page.choose("feature", "params.p")
    page.settled()
    assert "onerror" in page.text("chart")
    page.typed(f"ego = Object at (0, 0)\nassert False, {text}\n")
    assert "onerror" in page.text("problems")
    assert page.driver.execute_script("return document.title") == "program.scenic, scenic-ref play"
    assert not page.driver.find_elements("css selector", "img, #grid script, #problems script, iframe")
    assert len(page.driver.find_elements("tag name", "script")) == 2


def test_a_program_cannot_break_out_of_the_page_that_it_is_shipped_in(browser: Any, serve: Any, tmp_path: Path):
    (tmp_path / "mine.scenic").write_text(f"ego = Object at (0, 0)  # {HOSTILE}\n", encoding="utf-8")
    with serve("mine.scenic") as server:
        page = Page(browser, server)
        page.open()
        assert page.program() == f"ego = Object at (0, 0)  # {HOSTILE}\n"
        assert page.driver.execute_script("return document.title") == "mine.scenic, scenic-ref play"
        assert page.problems() == []


def test_an_endless_loop_is_told_and_the_next_program_is_drawn(page: Page):
    page.typed("while True:\n    pass\nego = Object at (0, 0)\n")
    assert "without ending" in page.text("message")
    assert page.marked("error")
    page.typed("ego = Object at (0, 0)\n")
    assert len(page.scenes()) == 12
    assert page.text("message") == ""


def test_typing_ends_what_was_being_drawn(page: Page):
    page.put("x = Range(0, 1)\nego = Object at (0, 0)\nfor i in range(300):\n    y = [j for j in range(100)]\nrequire x > 2\n")
    page.until(lambda: "drawing" in page.text("status"))
    page.typed("ego = Object at (0, 0)\n")
    assert len(page.scenes()) == 12


def test_a_server_that_has_ended_is_told(browser: Any, serve: Any):
    with serve() as server:
        page = Page(browser, server)
        page.open()
        server.terminate()
        server.wait()
        page.typed("ego = Object at (1, 0)\n")
        assert "does not answer" in page.text("message")
        page.problems()


def test_a_program_from_a_link_does_not_run_with_trust_until_it_is_allowed(browser: Any, serve: Any):
    with serve("--trust") as server:
        page = Page(browser, server)
        page.open()
        assert len(page.scenes()) == 12
        page.open("#" + link_of(Linked("ego = Object at (7, 7)\n", 0, {})))
        assert page.element("ask").is_displayed()
        assert page.scenes() == []
        page.element("run-it").click()
        page.until(lambda: "at (7, 7)" in "".join(page.scenes()))


def test_programs_to_begin_with_have_scenes_and_can_be_undone(page: Page):
    from selenium.webdriver import Keys

    before = page.program()
    for number in range(6):
        page.choose("examples", str(number))
        page.settled()
        assert len(page.scenes()) == 12, page.text("message")
        assert page.text("problems") == ""
    for _ in range(6):
        page.element("program").send_keys(Keys.CONTROL + "z")
    assert page.program() == before


def test_keys_indent_and_leave_the_editor(page: Page):
    from selenium.webdriver import Keys

    area = page.element("program")
    page.typed("")
    area.send_keys("def f():", Keys.ENTER, "return 1", Keys.ENTER, Keys.SHIFT, Keys.TAB, Keys.SHIFT, "ego = Object")
    assert page.program() == "def f():\n    return 1\nego = Object"
    area.send_keys(Keys.ESCAPE, Keys.TAB)
    assert page.driver.execute_script("return document.activeElement.id") != "program"


def test_tabs_are_reached_by_keys(page: Page):
    from selenium.webdriver import Keys

    page.element("tab-scenes").send_keys(Keys.ARROW_RIGHT)
    assert page.driver.execute_script("return document.activeElement.id") == "tab-rejections"
    assert page.element("rejections").is_displayed()
    assert not page.element("scenes").is_displayed()


def test_everything_that_is_used_has_a_name(page: Page):
    unnamed = page.driver.execute_script(
        "return [...document.querySelectorAll('button, input, select, textarea, [role=img]')].filter(e => !(e.getAttribute('aria-label') || "
        "e.textContent.trim() || (e.labels && e.labels.length) || e.placeholder)).map(e => e.outerHTML.slice(0, 80))"
    )
    assert unnamed == []


def test_a_narrow_window_has_everything_below_each_other(page: Page):
    page.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 420, "height": 800, "deviceScaleFactor": 1, "mobile": False})
    for name in ("rejections", "histogram", "trace", "readings", "replay", "scenes"):
        page.tab(name)
        wide = page.driver.execute_script("return [document.documentElement.scrollWidth, innerWidth]")
        assert wide[0] <= wide[1], name
