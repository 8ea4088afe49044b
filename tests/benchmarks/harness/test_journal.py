"""Nothing that was measured is lost, and nothing that was measured otherwise gets in."""

import math
import shutil
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import benchmarks
import sinuous
from benchmarks.harness import journal
from benchmarks.harness.journal import Journal, code_version
from sinuous.base.errors import InputError

SETTINGS: dict[str, Any] = {"seed": 3, "sizes": (5, 10), "code": "abc"}


def opened(folder: Path, *, anew: bool = False, **changes: Any) -> Journal:
    return Journal.open(folder, {**SETTINGS, **changes}, anew=anew)


def test_pieces_are_there_again(tmp_path: Path) -> None:
    first = opened(tmp_path / "new" / "folder")
    first.add("a", {"seconds": 1e-5, "clearance": math.inf})
    first.add("b", [1, 2])
    again = opened(tmp_path / "new" / "folder")
    assert again.pieces == {"a": {"seconds": 1e-5, "clearance": None}, "b": [1, 2]}
    assert first.pieces == again.pieces


@pytest.mark.parametrize("torn", ['{"piece": "b", "mea', '{"piece": "b", "measured": 2}', "\n", "3\n", "\0\0\0"])
def test_a_torn_end_costs_that_line_only(tmp_path: Path, torn: str) -> None:
    opened(tmp_path).add("a", 1)
    with (tmp_path / journal.NAME).open("a") as stream:
        stream.write(torn)
    again = opened(tmp_path)
    assert again.pieces == {"a": 1}
    again.add("c", 3)
    assert opened(tmp_path).pieces == {"a": 1, "c": 3}


def test_other_settings_are_refused_by_name(tmp_path: Path) -> None:
    opened(tmp_path).add("a", 1)
    with pytest.raises(InputError, match=r"--out: .*--anew, .*\(seed was 3, is 4\)"):
        opened(tmp_path, seed=4)
    with pytest.raises(InputError, match=r"\(code was abc, is abd\)"):
        opened(tmp_path, code="abd")
    with pytest.raises(InputError, match=r"\(more was not set, is 1\)"):
        opened(tmp_path, more=1)
    assert opened(tmp_path).pieces == {"a": 1}


def test_anew_forgets(tmp_path: Path) -> None:
    opened(tmp_path).add("a", 1)
    assert opened(tmp_path, anew=True, seed=4).pieces == {}
    assert opened(tmp_path, seed=4).pieces == {}


@pytest.mark.parametrize("content", ["", "something else\n", '{"settings"', "[]\n", '{"settings": 3}\n'])
def test_a_file_that_is_no_journal_is_left_alone(tmp_path: Path, content: str) -> None:
    (tmp_path / journal.NAME).write_text(content)
    with pytest.raises(InputError, match="cannot be read"):
        opened(tmp_path)
    assert (tmp_path / journal.NAME).read_text() == content


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="is a file"):
        opened(tmp_path / "file")


@pytest.mark.parametrize(
    ("package", "file"), [(sinuous, "kernels/compile.py"), (benchmarks, "harness/journal.py")], ids=["library", "bench"]
)
def test_the_code_version_sees_every_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, package: ModuleType, file: str
) -> None:
    copy = tmp_path / "package"
    shutil.copytree(Path(str(package.__file__)).parent, copy, ignore=shutil.ignore_patterns("__pycache__"))
    here = code_version()
    monkeypatch.setattr(package, "__file__", str(copy / "__init__.py"))
    assert code_version() == here
    with (copy / file).open("a") as stream:
        stream.write("\n")
    assert code_version() != here
