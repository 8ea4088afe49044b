"""Numba by itself runs with versions that were not tried. That it does the same: `test_conformance`."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]

OTHER = """
import sys
import numba
numba.__version__ = "9.1.0"
from sinuous.kernels.compile import sources
from tests.kernels.compile import parts
assert sources.COMPILER == "numba"
assert not {f"sinuous.kernels.compile.{name}" for name in ("once",)} & sys.modules.keys()
assert parts.thrice_the_longest(3.0, 4.0) == 27.0
assert parts.twice_the_shortest(3.0, -4.0) == 6.0
print(sum(parts.thrice_the_longest.stats.cache_hits.values()))
"""


def test_with_another_version_numba_compiles_by_itself_and_its_code_is_kept(tmp_path: Path) -> None:
    words = {**os.environ, "SINUOUS_CACHE": str(tmp_path), "SINUOUS_KERNELS": "compiled"}
    for read in (0, 1):
        ran = subprocess.run(
            [sys.executable, "-c", OTHER], cwd=ROOT, env=words, capture_output=True, text=True, check=True
        )
        assert (ran.stdout, ran.stderr) == (f"{read}\n", "")


def test_another_compiler_is_refused() -> None:
    command, words = [sys.executable, "-c", "import sinuous.kernels.compile"], {**os.environ, "SINUOUS_COMPILER": "gcc"}
    ran = subprocess.run(command, env=words, capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert ran.stderr.splitlines()[-1].endswith("unknown SINUOUS_COMPILER 'gcc'; expected one of linked, numba")
