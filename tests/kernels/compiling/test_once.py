"""Parts are optimised with the entry that calls them, and nobody else is given them."""

import math
import re
from typing import Any

import numba
import numpy as np
import pytest
from llvmlite import binding as llvm

from sinuous.kernels import compile as compiling
from sinuous.kernels.compiling import once, store
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array
from tests.kernels.compiling import parts


def symbols(entry: Any) -> set[str]:
    """Functions that the engine could give to other code by their names."""
    (result,) = entry.overloads.values()
    return {
        function.name
        for function in result.library._final_module.functions
        if not function.is_declaration and function.linkage.name != "private"
    }


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    monkeypatch.setattr(store, "CACHE", tmp_path_factory.mktemp("cache"))


@pytest.mark.usefixtures("fresh")
def test_an_entry_shows_nothing_but_itself() -> None:
    entry = compiling.entry(parts.twice_the_norm.py_func)  # type: ignore[attr-defined]
    assert entry(3.0, 4.0) == 10.0
    assert all("twice_the_norm" in name for name in symbols(entry))
    assert len(symbols(entry)) == 2  # the function, and the wrapper that Python calls


njit: Any = numba.njit


@njit  # type: ignore[untyped-decorator]
def climb(x: float, steps: int, height: float) -> float:
    """Too much to be copied into its callers; where all of these go equally high, that height is made part of it."""
    return x if steps <= 0 else climb(x + height, steps - 1, height) + 0.0 * math.sin(x)


@pytest.mark.usefixtures("fresh")
def test_code_of_users_is_not_mixed_up_with_what_an_entry_was_made_of() -> None:
    """What others compiled keeps its name where it is linked; optimised here, it is something else."""

    def ours(steps: int) -> float:
        return float(climb(1.0, steps, 2.0))

    def theirs(steps: int, height: float) -> float:
        return float(climb(1.0, steps, height))

    entry = compiling.entry(ours)
    assert entry(3) == 7.0
    assert njit(theirs)(3, 5.0) == 16.0
    assert entry(3) == 7.0


@pytest.mark.usefixtures("fresh")
def test_helpers_of_numba_serve_users_as_before() -> None:
    def ours(a: Array, n: int) -> float:
        b = a.reshape((n, a.size // n))
        return float(b[n - 1, 0] + shaped(a, (n, a.size // n))[0, 1] + max(b[0, 0], 1.0))

    def theirs(a: Array, n: int, m: int) -> float:
        b = a.reshape((n, m))
        return float(b[n - 1, m - 1] * 1000 + b[0, m - 1] + min(b[0, 0], 1.0))

    values = np.arange(24.0)
    own, user = compiling.entry(_copy(ours)), njit(theirs)
    assert own(values, 4) == 18.0 + 1.0 + 1.0
    for n, m in ((2, 12), (3, 8), (6, 4), (24, 1)):
        assert user(values, n, m) == 23000.0 + (m - 1) + 0.0
    assert own(values, 4) == 18.0 + 1.0 + 1.0


def _copy(function: Any) -> Any:
    return type(function)(function.__code__, function.__globals__)


def test_code_that_numba_compiles_by_itself_can_call_kernels() -> None:
    norm = compiling.compiled_form(parts.norm)

    def twice(x: float) -> float:
        return float(2.0 * norm(x, 4.0))

    assert njit(twice)(3.0) == 10.0
    assert compiling.entry(twice)(3.0) == 10.0


@pytest.mark.usefixtures("fresh")
def test_entries_call_the_machine_code_of_a_shared_kernel() -> None:
    """An entry has the kernels that it calls in it; a shared one is there once, and only its name is in the entry."""
    thrice, both = (compiling.entry(one.py_func) for one in (parts.thrice_the_longest, parts.longest_and_norm))  # type: ignore[attr-defined]
    assert thrice(3.0, 4.0) == 27.0
    assert both(3.0, 4.0) == 14.0
    (result,) = compiling.compiled_form(parts.longest).overloads.values()
    for entry in (thrice, both):
        (made,) = entry.overloads.values()
        assert made.library.parts == [result.library]
        assert made.library._final_module.get_function(result.fndesc.mangled_name).is_declaration


def test_what_is_linked_two_by_two_is_all_there() -> None:
    """In a module alone nobody calls it yet."""
    declared = "".join(f"declare void @f{i}()\n" for i in range(6))
    modules = [
        llvm.parse_assembly(
            declared.replace(f"declare void @f{i}()", f"define linkonce_odr void @f{i}() {{ {call} ret void }}")
        )
        for i in range(5)
        for call in [f"call void @f{i + 1}()"]
    ]
    defined = {one.name for one in once._joined(modules).functions if not one.is_declaration}
    assert defined == {f"f{i}" for i in range(5)}


@pytest.mark.usefixtures("fresh")
def test_a_kernel_apart_is_called_not_copied() -> None:
    for function, name, copied in ((parts.twice_the_norm, "norm", True), (parts.twice_the_shortest, "shortest", False)):
        entry = compiling.entry(function.py_func)  # type: ignore[attr-defined]
        assert entry(3.0, -4.0) == (10.0 if copied else 6.0)
        (made,) = entry.overloads.values()
        own = {one.name.split("5parts")[1] for one in made.library._final_module.functions if "5parts" in one.name}
        assert any(one.startswith(f"{len(name)}{name}") for one in own) is not copied


def test_code_that_numba_compiles_by_itself_can_call_what_calls_shared_kernels() -> None:
    """Numba may keep it on disk, for processes that have no shared kernel: it is in that code, as everything is."""
    longest = compiling.compiled_form(parts.longest)

    def twice(x: float) -> float:
        return float(2.0 * longest(x, 4.0) + parts.thrice_the_longest(x, 4.0))

    user = njit(twice)
    assert user(3.0) == 45.0
    (result,) = user.overloads.values()
    declared = {one.name for one in result.library._final_module.functions if one.is_declaration}
    assert not any("longest" in name for name in declared)


@pytest.mark.usefixtures("fresh")
def test_names_are_the_same_in_every_process() -> None:
    """Numba numbers functions as they come; kernels are called by what they depend on."""
    parts.twice_the_norm(3.0, 4.0)
    (result,) = compiling.compiled_form(parts.norm).overloads.values()
    name = store.Store(parts.norm, "inner").name
    assert re.fullmatch("inner[0-9a-f]{16}", name)
    assert name != store.Store(parts.square, "inner").name
    assert "inner" in result.fndesc.mangled_name


def test_an_untried_numba_compiles_as_it_does_by_itself(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    monkeypatch.setattr(store, "CACHE", tmp_path_factory.mktemp("cache"))
    monkeypatch.setattr(numba, "__version__", "9.1.0")
    assert not once.tried()

    def quarter(x: float) -> float:
        return 0.25 * x

    inner = compiling.kernel(_copy(quarter))
    plain = compiling.compiled_form(inner)

    def both(x: float) -> float:
        return float(plain(x) + plain(2.0 * x))

    entry = compiling.entry(both)
    assert entry(4.0) == 3.0
    (result,) = plain.overloads.values()
    assert not isinstance(result.library, once.LoweredKernel)


def test_this_numba_is_tried() -> None:
    assert once.tried()
