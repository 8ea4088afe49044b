"""Parts are optimised with the entry that calls them, and nobody else is given them."""

import math
from typing import Any

import numba
import pytest

from sinuous.kernels import compile as compiling
from sinuous.kernels.compile import store
from tests.kernels.compile import parts


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


@pytest.mark.usefixtures("fresh")
def test_a_kernel_apart_is_called_not_copied() -> None:
    for function, name, copied in ((parts.twice_the_norm, "norm", True), (parts.twice_the_shortest, "shortest", False)):
        entry = compiling.entry(function.py_func)  # type: ignore[attr-defined]
        assert entry(3.0, -4.0) == (10.0 if copied else 6.0)
        (made,) = entry.overloads.values()
        own = {one.name.split("5parts")[1] for one in made.library._final_module.functions if "5parts" in one.name}
        assert any(one.startswith(f"{len(name)}{name}") for one in own) is not copied
