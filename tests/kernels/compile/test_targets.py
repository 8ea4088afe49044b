"""Code that is shipped is read where the processor has all that it was compiled for, and nowhere else."""

import base64
import hashlib
import json
import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from llvmlite import binding as llvm

import build_kernels
from sinuous.kernels import compile as compiling
from sinuous.kernels.compile import store, targets


def third(x: float) -> float:
    return x / 3.0


@pytest.fixture
def level(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Folder of a level that is shipped; all else is in a store of its own."""
    monkeypatch.setattr(store, "CACHE", tmp_path / "store")
    monkeypatch.setattr(targets, "PREBUILT", tmp_path / "prebuilt")
    folder = tmp_path / "prebuilt" / "level"
    folder.mkdir(parents=True)
    yield folder
    targets.shipped.cache_clear()


HERE = llvm.get_process_triple()
FEATURE = next(name for name, has in llvm.get_host_cpu_features().items() if has)


@pytest.mark.parametrize(
    ("triple", "features", "damaged", "read"),
    [
        (HERE, "", False, True),
        (HERE, f"+{FEATURE}", False, True),
        (HERE, "", True, False),
        (HERE, "+of another", False, False),
        ("pdp11-unknown-unix", "", False, False),
    ],
    ids=["for all", "for less than this has", "damaged", "for more", "for another system"],
)
def test_what_is_shipped_is_read_where_it_runs(
    level: Path, triple: str, features: str, damaged: bool, read: bool
) -> None:
    target = targets.Processor(triple, "generic", features)
    (level / targets.NAME).write_text(json.dumps(target), encoding="utf-8")
    first: Any = compiling.entry(third)
    assert first(3.0) == 1.0
    (own,), (signature,) = store.CACHE.glob("third*.code"), first.signatures
    shipped = Path(shutil.move(own, level / first._cache._file_name(signature, target)))
    if damaged:
        shipped.write_bytes(b"x" * 99)
    targets.shipped.cache_clear()
    again: Any = compiling.entry(third)
    assert again(6.0) == 2.0
    assert sum(again.stats.cache_hits.values()) == read
    assert bool(list(store.CACHE.glob("third*"))) is not read


def test_a_wheel_has_the_code_and_a_name_that_says_for_what(tmp_path: Path) -> None:
    plain, level = tmp_path / "sinuous-1.0-py3-none-any.whl", tmp_path / "x86-64-v3"
    level.mkdir()
    (level / "a.code").write_bytes(b"code")
    with zipfile.ZipFile(plain, "w") as archive:
        archive.writestr("sinuous/__init__.py", "")
        archive.writestr("sinuous-1.0.dist-info/WHEEL", "Root-Is-Purelib: true\nTag: py3-none-any\n")
        archive.writestr("sinuous-1.0.dist-info/RECORD", "")
    wheel = build_kernels.pack(plain, [level], tmp_path, "manylinux_2_28_x86_64")
    assert wheel.name.startswith("sinuous-1.0-cp3")
    with zipfile.ZipFile(wheel) as archive:
        record = archive.read("sinuous-1.0.dist-info/RECORD").decode().splitlines()
        assert b"Root-Is-Purelib: false" in archive.read("sinuous-1.0.dist-info/WHEEL")
    digest = base64.urlsafe_b64encode(hashlib.sha256(b"code").digest()).decode().rstrip("=")
    assert f"sinuous/kernels/prebuilt/x86-64-v3/a.code,sha256={digest},4" in record
    assert record[-1] == "sinuous-1.0.dist-info/RECORD,,"
