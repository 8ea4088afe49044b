"""Whatever ends a batch, for real: nothing is lost, nothing is done twice, and one line says what happened."""

import json
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.studies.batch.batch import Batch
from tests.base.processes import PATIENCE, Command
from tests.studies.batch.questions import BALL, ROBOT, points

ROWS, CHUNK = 6_000, 100
TIME = 60.0
"""Seconds for a target: none ends by the clock, whatever else the machine does, so files are equal byte for byte."""

Process = Command | subprocess.Popen[str]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    sn.Job(ROBOT, sn.Target((0, 0, 150)), [BALL]).save(tmp_path / "arm.yaml")
    np.savez(tmp_path / "in.npz", positions=points(ROWS))
    return tmp_path


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("whole")
    np.savez(folder / "in.npz", positions=points(ROWS))
    go_on(folder / "out.npz")
    return (folder / "out.npz").read_bytes()


def typed(*options: str, out: str = "out.npz") -> list[str]:
    own = f"batch arm.yaml --targets in.npz --out {out} --chunk {CHUNK} --max-starts 4 --no-routes --time {TIME}"
    return [*own.split(), *options]


def parts(folder: Path, out: str = "out.npz") -> dict[str, int]:
    """Chunks that are there, and when they were written."""
    found = (folder / f"{out}.parts").glob("chunk-*.npz")
    return {file.name: file.stat().st_mtime_ns for file in found}


def until(process: Process, ready: Callable[[], Any]) -> None:
    end = time.monotonic() + PATIENCE
    while not ready():
        assert (process.code if isinstance(process, Command) else process.poll()) is None
        assert time.monotonic() < end
        time.sleep(0.005)


def go_on(out: Path, **options: Any) -> Batch:
    settings: dict[str, Any] = {"max_starts": 4, "routes": False, "chunk": CHUNK, "time": TIME}
    return sn.studies.solve_batch(ROBOT, out.with_name("in.npz"), [BALL], out, **settings, **options)


def finish(folder: Path, expected: bytes) -> None:
    """Go on, and look at what is there at the end."""
    before = parts(folder)
    assert before
    assert len(before) < ROWS // CHUNK
    assert go_on(folder / "out.npz", shard=(1, 1)).before == CHUNK * len(before)  # a shard leaves chunks where they are
    after = parts(folder)
    assert {name: after[name] for name in before} == before  # none twice
    assert len(after) == ROWS // CHUNK  # none lost
    assert go_on(folder / "out.npz").before == ROWS
    assert (folder / "out.npz").read_bytes() == expected


def one_line(process: Command, *words: str) -> None:
    told = "".join(line for line in process.said().splitlines(keepends=True) if not line.startswith("note: "))
    assert told.count("\n") == 1, told
    assert all(word in told for word in words), told


def test_killed(folder: Path, expected: bytes) -> None:
    """As somebody types it, in a process that begins with nothing."""
    command = [sys.executable, "-m", "sinuous", *typed()]
    with subprocess.Popen(command, cwd=folder, text=True, stderr=subprocess.DEVNULL) as process:
        until(process, lambda: len(parts(folder)) >= 5)
        process.kill()
    finish(folder, expected)


@contextmanager
def small_disk(place: Path, size: str) -> Iterator[None]:
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(place)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("no small disk can be mounted here")
    try:
        yield
    finally:
        subprocess.run(["umount", str(place)], check=True)


def test_the_disk_is_full(folder: Path, expected: bytes) -> None:
    with small_disk(folder / "small", "400k"):
        process = Command(typed(out="small/out.npz"), folder)
        one_line(process, "No space left on device", "chunks are kept", "goes on")
        assert process.code == 1
        assert parts(folder, "small/out.npz")
        for file in (folder / "small").rglob("*.npz"):
            assert not file.name.startswith(".")  # no half of a file
        shutil.copytree(folder / "small", folder, dirs_exist_ok=True)
    finish(folder, expected)


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, subprocess.Popen[str], list[subprocess.Popen[str]]]]:
    pytest.importorskip("distributed")
    file = folder / "scheduler.json"
    own = {"cwd": folder, "text": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    module = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard"]
    begun = [subprocess.Popen([*module, "--host", "127.0.0.1", "--scheduler-file", str(file)], **own)]  # type: ignore[call-overload]
    until(begun[0], lambda: file.exists() and file.read_text(encoding="utf-8").strip())
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny", "--no-dashboard"]
    command = [*worker, "--scheduler-file", str(file)]
    begun.extend(subprocess.Popen(command, **own) for _ in range(workers))  # type: ignore[call-overload]
    try:
        yield json.loads(file.read_text(encoding="utf-8"))["address"], begun[0], begun[1:]
    finally:
        for process in begun:
            process.kill()
            process.wait()


def test_dask_loses_a_worker_and_then_its_scheduler(folder: Path, expected: bytes) -> None:
    with cluster(folder, 2) as (address, scheduler, workers):
        process = Command(typed("--dask", address), folder)
        until(process, lambda: len(parts(folder)) >= 5)
        workers[0].kill()
        until(process, lambda: len(parts(folder)) >= 12)
        scheduler.kill()
        one_line(process, "scheduler", "chunks are kept", "goes on")
        assert process.code == 1
    finish(folder, expected)
