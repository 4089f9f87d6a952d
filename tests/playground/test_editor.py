"""The editor of the playground's page in headless Chromium: colours, marks and margin."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.editors.pygments_lexer import ScenicLexer

from .conftest import Page

pytestmark = [pytest.mark.extra("play"), pytest.mark.slow]
EXAMPLES = Path(scenic_ref.__file__).parent / "examples"


def test_an_error_is_underlined_where_it_stands(page: Page):
    page.typed("ego = Object at (0, 0)\n# 𝔘 ist ein Buchstabe\nother = Object at ('𝔘', nosuch)\n")
    assert page.marked("error") == ["nosuch"]
    assert "error, line 3: nosuch is not defined" in page.text("problems")
    page.driver.find_element("css selector", "#problems button").click()
    assert page.driver.execute_script("return program.value.slice(program.selectionStart, program.selectionEnd)") == "nosuch"
    box = "return document.querySelector(arguments[0]).getBoundingClientRect().toJSON()"
    under, over = (page.driver.execute_script(box, name) for name in ("#marks .error", "#program"))
    assert under["top"] - over["top"] == pytest.approx(8 + 2 * 20, abs=4)
    page.typed("ego = Object at (0, 0)\nimport math\n")
    assert page.marked("error") == []
    assert page.marked("warning") == ["math"]
    assert len(page.scenes()) == 12


@pytest.mark.parametrize(
    "program",
    [
        "ego = Object at (0, 0), with note '" + "x" * 200_000 + "'\n", "# " + "x" * 300_000 + "\nego = Object at (0, 0)\n",
        "x = 1\n" * 300 + "ego = Object\n",
    ],
)  # fmt: skip
def test_long_programs_are_typed_in(page: Page, program: str):
    page.typed(program)
    assert len(page.scenes()) == 12


@pytest.mark.parametrize("path", sorted(EXAMPLES.rglob("*.scenic"))[::6], ids=lambda path: path.stem)
def test_the_page_colours_programs_as_the_lexer_does(page: Page, path: Path):
    from pygments.token import STANDARD_TYPES

    text = path.read_text()
    expected = [(value, STANDARD_TYPES[kind]) for _, kind, value in ScenicLexer().get_tokens_unprocessed(text)]
    found = page.driver.execute_script("return [...pieces(arguments[0])]", text)
    assert [tuple(piece) for piece in found if piece[0]] == [piece for piece in expected if piece[0]]


def test_of_a_program_of_thousands_of_lines_those_in_view_are_drawn(page: Page):
    """With all of its 20,000 lines in the layers, one key took more than a minute; so did Control-A with a closed `details` on the page."""
    from selenium.webdriver import Keys

    give = "const p = document.getElementById('program'); p.focus(); p.value = arguments[0]; p.dispatchEvent(new Event('input'));"
    page.driver.execute_script(give, "ego = Object at (0, 0)\n" + "x = 1\n" * 20_000 + "y = nosuch\n")
    assert page.driver.find_elements("tag name", "details") == []
    page.element("program").send_keys("z = 2  # typed")
    page.settled()
    assert page.marked("error") == ["nosuch"]
    drawn = "return ['colours', 'marks', 'gutter'].map(name => document.querySelectorAll('#' + name + ' *').length)"
    assert max(page.driver.execute_script(drawn)) < 1000
    rows = (
        "return [...document.querySelectorAll('#gutter div div')].filter(e => e.textContent === arguments[0])"
        ".map(e => e.getBoundingClientRect().top)"
    )
    box = "return document.querySelector('#marks .error').getBoundingClientRect().top"
    [row] = page.driver.execute_script(rows, "20002")
    assert page.driver.execute_script(box) == pytest.approx(row, abs=4)
    assert page.driver.execute_script(rows, "1") == []
    page.element("program").send_keys(Keys.CONTROL + Keys.HOME)
    page.until(lambda: len(page.driver.execute_script(rows, "1")) == 1)
    over = page.driver.execute_script("const p = document.getElementById('program'); return p.getBoundingClientRect().top - p.scrollTop")
    assert page.driver.execute_script(rows, "1")[0] == pytest.approx(over + 8, abs=4)
    assert page.marked("error") == []


def test_letters_that_are_not_seen_are_marked_wherever_they_stand(page: Page):
    page.typed("ego = Object at (0, 0)\n\u202ey = 1\nz\u200e = 2  # \u202e\n")
    found = page.driver.execute_script("return [...document.querySelectorAll('#colours .odd')].map(e => e.textContent)")
    assert found == ["\u202e", "\u200e", "\u202e"]


def test_the_margin_is_as_wide_wherever_the_text_is_scrolled_to(page: Page):
    page.typed("ego = Object at (0, 0)\n" + "x = 1\n" * 1200 + "require Range(0, 1) > 0.5\n")
    widths = set()
    for top in (0, 5000, 30000):
        page.driver.execute_script("program.scrollTop = arguments[0]", top)
        page.until(lambda: page.driver.execute_script("const row = program.scrollTop / 20; return seen.first <= row && row <= seen.last"))
        widths.add(page.driver.execute_script("return document.getElementById('gutter').getBoundingClientRect().width"))
    assert len(widths) == 1
