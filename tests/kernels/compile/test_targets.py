"""Code that is shipped is read where the processor has all that it was compiled for, and nowhere else."""

import base64
import hashlib
import json
import shutil
import zipfile
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
def prebuilt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Ship a level, and keep all else in a store of its own."""
    monkeypatch.setattr(store, "CACHE", tmp_path / "store")
    monkeypatch.setattr(targets, "PREBUILT", tmp_path / "prebuilt")
    targets.shipped.cache_clear()
    level = tmp_path / "prebuilt" / "level"
    level.mkdir(parents=True)
    return level


def ship(level: Path, features: str) -> str:
    """Move what the store has of `third` to what is shipped for a target; return its name."""
    target = targets.Processor(llvm.get_process_triple(), "generic", features)
    (level / targets.NAME).write_text(json.dumps(target), encoding="utf-8")
    entry: Any = compiling.entry(third)
    assert entry(3.0) == 1.0
    (own,) = store.CACHE.glob("third*.code")
    (signature,) = entry.signatures
    shipped = entry._cache._file_name(signature, target)
    shutil.move(own, level / shipped)
    targets.shipped.cache_clear()
    return str(shipped)


def test_what_is_shipped_for_less_than_this_processor_has_is_read(prebuilt: Path) -> None:
    feature = next(name for name, has in llvm.get_host_cpu_features().items() if has)
    ship(prebuilt, f"+{feature}")
    entry: Any = compiling.entry(third)
    assert entry(6.0) == 2.0
    assert sum(entry.stats.cache_hits.values()) == 1
    assert not list(store.CACHE.glob("third*"))
    targets.shipped.cache_clear()


@pytest.mark.parametrize("change", [{"features": "+of another"}, {"triple": "pdp11-unknown-unix"}])
def test_what_is_shipped_for_more_is_not(prebuilt: Path, change: dict[str, str]) -> None:
    ship(prebuilt, change.get("features", ""))
    told = json.loads((prebuilt / targets.NAME).read_text(encoding="utf-8"))
    (prebuilt / targets.NAME).write_text(json.dumps([change.get("triple", told[0]), *told[1:]]), encoding="utf-8")
    targets.shipped.cache_clear()
    entry: Any = compiling.entry(third)
    assert entry(6.0) == 2.0
    assert sum(entry.stats.cache_hits.values()) == 0
    targets.shipped.cache_clear()


def test_what_is_shipped_damaged_is_compiled(prebuilt: Path) -> None:
    name = ship(prebuilt, "")
    (prebuilt / name).write_bytes(b"x" * 99)
    entry: Any = compiling.entry(third)
    assert entry(6.0) == 2.0
    assert list(store.CACHE.glob("third*"))
    targets.shipped.cache_clear()


def test_levels_grow() -> None:
    two, three, four = (set(targets.LEVELS[f"x86-64-v{i}"].split()) for i in (2, 3, 4))
    assert two < three < four
    assert targets.settings("x86-64-v2")["NUMBA_CPU_FEATURES"].startswith("+cx16,")


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
