"""The programs of the README run."""

import pathlib
import re

import pytest

README = (pathlib.Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


@pytest.mark.parametrize("block", range(len(BLOCKS)))
def test_a_program_of_the_readme(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(BLOCKS[block], "README.md", "exec"), {})  # noqa: S102
    assert list(tmp_path.iterdir())


def test_there_are_programs():
    assert len(BLOCKS) >= 2
