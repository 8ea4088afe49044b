"""Where figures come from: a figure without its machine says nothing."""

import platform
import subprocess
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter, thread_time

import sinuous
from sinuous.kernels.compile import cores

LOOK = 0.05
"""Seconds of a look at how busy the machine is."""

PACKAGES = ("numpy", "scipy", "numba", "casadi", "libigl", "ompl")


def describe() -> dict[str, str]:
    """Processor, system, versions, commit and date, as text."""
    return {
        "date": datetime.now().astimezone().isoformat(timespec="seconds"),
        "processor": _processor(),
        "cores": str(cores()),
        "system": platform.platform(),
        "python": platform.python_version(),
        "sinuous": sinuous.__version__ + _commit(),
        **{name: _version(name) for name in PACKAGES},
    }


def busy() -> float:
    """Share of the time in which other processes had the processor, 0 to 1, while this one wanted it."""
    began, worked = perf_counter(), thread_time()
    while (spent := perf_counter() - began) < LOOK:
        pass
    return max(0.0, 1.0 - (thread_time() - worked) / spent)


def _processor() -> str:
    listing = Path("/proc/cpuinfo")
    if listing.exists():
        for line in listing.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _commit() -> str:
    """Commit of the working tree that the package lies in, if it lies in one; a plus marks changes since."""
    folder = Path(__file__).parents[1]
    try:
        commit = _git(folder, "rev-parse", "--short=12", "HEAD")
        changed = _git(folder, "status", "--porcelain", "--", str(folder.parent))
    except (OSError, subprocess.SubprocessError):
        return ""
    return f" ({commit}{'+' if changed else ''})"


def _git(folder: Path, *arguments: str) -> str:
    run = subprocess.run(["git", *arguments], cwd=folder, capture_output=True, text=True, check=True, timeout=10)
    return run.stdout.strip()
