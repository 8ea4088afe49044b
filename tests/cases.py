"""Many small cases of one law in one test: pytest alone takes longer for a test of its own than such a case does."""

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any

Test = Callable[..., None]


def with_each(
    names: str | tuple[str, ...], cases: Iterable[Any] | Callable[[], Iterable[Any]]
) -> Callable[[Test], Test]:
    """Try a test with each of these cases, given as to `pytest.mark.parametrize`; an error names the case.

    A function that returns cases is called by the test: what takes long, or compiles, is not made while tests are
    collected, when the other processes wait.
    """
    keys = (names,) if isinstance(names, str) else names
    given = list(cases) if isinstance(cases, Iterable) else cases  # an enumeration can be called, too

    def all_of(test: Test) -> Test:
        @wraps(test)
        def tried(**others: Any) -> None:
            for one in given() if callable(given) else given:
                case = dict(zip(keys, (one,) if isinstance(names, str) else one, strict=True))
                try:
                    test(**others, **case)
                except Exception as error:
                    error.add_note(f"with {case}")
                    raise

        signature = inspect.signature(test)
        rest = [one for name, one in signature.parameters.items() if name not in keys]
        tried.__signature__ = signature.replace(parameters=rest)  # type: ignore[attr-defined]
        return tried

    return all_of
