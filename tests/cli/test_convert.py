"""`scenic-ref convert`."""

from __future__ import annotations

from pathlib import Path

PROGRAM = "ego = Object at (0, 0)  # here\nrequire ego.width > 0\n"
IN_3 = "# dialect: scenic-3\nego = new Object at (0, 0)  # here\nrequire ego.width > 0\n"


def test_a_program_is_written_in_another_dialect(ask, tmp_path: Path) -> None:
    source = tmp_path / "p.scenic"
    source.write_text(PROGRAM)
    assert ask("convert", str(source), "--to", "scenic-3").out == IN_3
    target = tmp_path / "q.scenic"
    assert ask("convert", str(source), "--to", "scenic-3", "-o", str(target)).out == ""
    assert target.read_text() == IN_3
    assert ask("convert", str(target), "--to", "paper").out == PROGRAM


def test_what_is_wrong_is_said(ask, tmp_path: Path) -> None:
    source = tmp_path / "p.scenic"
    source.write_text("ego = new Object\nx = [new Object]\n")
    for options, code, said in (
        ((str(source), "--dialect", "scenic-3", "--to", "paper"), 1, "dialect paper cannot say this"),
        ((str(source), "--to", "scenic-4"), 2, "there is no dialect 'scenic-4'"),
        ((str(source), "--dialect", "scenic-3", "--to", "scenic-3", "-o", str(source)), 2, "is the program itself"),
        ((str(tmp_path / "none.scenic"), "--to", "paper"), 2, "there is no file"),
    ):
        answer = ask("convert", *options)
        assert answer.code == code
        assert said in answer.err
    assert "p.scenic:2:1" in ask("convert", str(source), "--dialect", "scenic-3", "--to", "paper").err
