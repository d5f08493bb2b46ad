"""Every example of the README runs."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


@pytest.mark.compiled
@pytest.mark.parametrize("source", blocks("python"))
def test_python(source: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(source, "README.md", "exec"), {"__name__": "__main__"})


@pytest.mark.compiled
def test_command_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    main: Callable[..., int],
) -> None:
    monkeypatch.chdir(tmp_path)
    x, y = np.meshgrid(np.linspace(-1, 1, 50), np.linspace(-1, 1, 40))
    np.save("heights.npy", 100 * np.exp(-3 * (x * x + y * y)))
    commands = [line for block in blocks("sh") for line in block.splitlines()]
    assert len(commands) >= 5
    for command in commands:
        program, *arguments = shlex.split(command)
        assert program == "gaussmap"
        code = main(arguments)
        printed = capsys.readouterr()
        assert code == 0, f"{command}: {printed.err}"
        assert printed.out.strip()
        if "-o" in arguments:
            assert Path(arguments[arguments.index("-o") + 1]).stat().st_size > 1000


def test_the_two_commands_are_targets() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for line in blocks("console")[0].splitlines():
        assert re.search(rf"^{line.removeprefix('make ')}:", makefile, re.MULTILINE)
