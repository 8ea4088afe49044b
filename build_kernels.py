"""Build a wheel that has machine code in it, for a level of instruction set: `python build_kernels.py x86-64-v3`.

Its kernels are compiled for this operating system, this version of Python, and the versions of Numba and llvmlite that
are installed; where it is installed with others, or on a processor without the features of the level, they are compiled
there, as from any other wheel.
"""

import argparse
import base64
import hashlib
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

from llvmlite import binding as llvm

from sinuous.kernels.compile.store import CACHE, CODE
from sinuous.kernels.compile.targets import LEVELS, NAME, settings

ROOT = Path(__file__).parent

SHOW_TARGET = """
import json
from numba.core.registry import cpu_target
from sinuous.kernels.compile.store import CACHE
print(json.dumps([str(CACHE), cpu_target.target_context.codegen().magic_tuple()]))
"""


def main() -> None:
    """Build the wheel."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("level", nargs="+", choices=list(LEVELS))
    parser.add_argument("--out", type=Path, default=ROOT / "dist")
    parser.add_argument("--tag", default=platform_tag(), help="the platform, as the name of the wheel has it")
    given = parser.parse_args()
    has = llvm.get_host_cpu_features()
    for level in given.level:
        missing = [feature for feature in LEVELS[level].split() if not has.get(feature, False)]
        if missing:
            parser.error(f"{level}: this processor, which has to run it once, has no {', '.join(missing)}")
    given.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", scratch, str(ROOT)]
        subprocess.run(command, check=True)
        (plain,) = Path(scratch).glob("*.whl")
        folders = [compiled(level, Path(scratch) / level) for level in given.level]
        print(pack(plain, folders, given.out, given.tag))  # noqa: T201


def platform_tag() -> str:
    """Return the platform of this machine: the code needs no library but the C library that Python itself needs."""
    return sysconfig.get_platform().replace("-", "_").replace(".", "_").replace("linux_", "manylinux_2_28_")


def compiled(level: str, folder: Path) -> Path:
    """Compile all entries for a level into a folder; what is the same for all processors is taken from the store."""
    shutil.copytree(CACHE, folder / "kernels", ignore=shutil.ignore_patterns("lock", "swept", f"*{CODE}*"))
    words = {**os.environ, **settings(level), "SINUOUS_CACHE": str(folder)}
    subprocess.run([sys.executable, "-m", "sinuous", "warm"], env=words, check=True)
    said = subprocess.run([sys.executable, "-c", SHOW_TARGET], env=words, check=True, capture_output=True, text=True)
    made = folder / "entries" / level
    made.mkdir(parents=True)
    for file in (folder / "kernels").glob(f"*{CODE}"):
        shutil.copy(file, made)
    (made / NAME).write_text(json.dumps(json.loads(said.stdout)[1]), encoding="utf-8")
    return made


def pack(plain: Path, folders: list[Path], out: Path, platform: str) -> Path:
    """Put the folders of levels into a copy of a wheel, and let its name say what it is for."""
    name, version, *_ = plain.name.split("-")
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    wheel = out / f"{name}-{version}-{python}-{python}-{platform}.whl"
    info = f"{name}-{version}.dist-info"
    files: dict[str, bytes] = {}
    with zipfile.ZipFile(plain) as archive:
        files = {each: archive.read(each) for each in archive.namelist() if each != f"{info}/RECORD"}
    told = files[f"{info}/WHEEL"].decode().replace("Root-Is-Purelib: true", "Root-Is-Purelib: false")
    files[f"{info}/WHEEL"] = told.replace("Tag: py3-none-any", f"Tag: {python}-{python}-{platform}").encode()
    for folder in folders:
        for file in sorted(folder.iterdir()):
            files[f"sinuous/kernels/prebuilt/{folder.name}/{file.name}"] = file.read_bytes()
    lines = [f"{each},sha256={digest(data)},{len(data)}" for each, data in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*lines, f"{info}/RECORD,,", ""]).encode()
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for each, data in files.items():
            archive.writestr(each, data)
    return wheel


def digest(data: bytes) -> str:
    """SHA-256 as records of wheels have it."""
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")


if __name__ == "__main__":
    main()
