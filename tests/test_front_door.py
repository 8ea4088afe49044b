"""What `import sinuous` offers, and what it costs."""

import subprocess
import sys

import pytest

import sinuous as sn


def test_every_name_is_there() -> None:
    for name in sn.__all__:
        assert getattr(sn, name) is not None
        assert name in dir(sn)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="'teleport'"):
        _ = sn.teleport


def test_the_import_brings_nothing_heavy() -> None:
    code = "import sys, sinuous; print(sorted({'numpy', 'numba', 'scipy', 'yaml', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
