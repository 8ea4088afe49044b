"""What machine code is compiled for: the processor at hand, or a level of instruction set that code is shipped for."""

import json
from functools import cache
from pathlib import Path
from typing import NamedTuple

from llvmlite import binding as llvm

from sinuous.kernels.compile.sources import PACKAGE

PREBUILT = PACKAGE / "kernels" / "prebuilt"
"""Folder of what a wheel ships: a folder for each level."""

NAME = "target.json"
"""File in the folder of a level that says what its code was compiled for."""

BASELINE = "cx16 fxsr mmx sse sse2 sse3 ssse3 sse4.1 sse4.2 popcnt sahf"
LEVELS: dict[str, str] = {
    "x86-64-v2": BASELINE,
    "x86-64-v3": f"{BASELINE} avx avx2 bmi bmi2 f16c fma lzcnt movbe xsave",
    "x86-64-v4": f"{BASELINE} avx avx2 bmi bmi2 f16c fma lzcnt movbe xsave avx512f avx512bw avx512cd avx512dq avx512vl",
    "armv8": "neon",
}
"""Features of the levels, as LLVM names them; the psABI of x86-64 has them."""


class Processor(NamedTuple):
    """A kind of processor.

    Attributes
    ----------
    triple, cpu : str
        Architecture and system, and the model that code is tuned for, as LLVM names them.
    features : str
        What it must have, like `+sse2,+avx`.
    """

    triple: str
    cpu: str
    features: str

    def runs_here(self) -> bool:
        """Say whether this processor has all of it."""
        has = llvm.get_host_cpu_features()
        asked = [one[1:] for one in self.features.split(",") if one.startswith("+")]
        return self.triple == llvm.get_process_triple() and all(has.get(one, False) for one in asked)


def settings(level: str) -> dict[str, str]:
    """Words of the environment with which Numba compiles for a level."""
    features = ",".join(f"+{one}" for one in LEVELS[level].split())
    return {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": features}


@cache
def shipped() -> list[tuple[Path, Processor]]:
    """Folders with code that runs here, that which asks for most first."""
    found = []
    for file in PREBUILT.glob(f"*/{NAME}"):
        target = Processor(*json.loads(file.read_text(encoding="utf-8")))
        if target.runs_here():
            found.append((file.parent, target))
    return sorted(found, key=lambda one: -len(one[1].features))
