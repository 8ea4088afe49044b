"""Many small cases of one law in one test: pytest alone takes longer for a test of its own than such a case does."""

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any

Test = Callable[..., None]


def with_each(names: str | tuple[str, ...], cases: Iterable[Any]) -> Callable[[Test], Test]:
    """Try a test with each of these cases, given as to `pytest.mark.parametrize`; an error names the case."""
    keys = (names,) if isinstance(names, str) else names
    listed = [dict(zip(keys, (case,) if isinstance(names, str) else case, strict=True)) for case in cases]

    def all_of(test: Test) -> Test:
        @wraps(test)
        def tried(**others: Any) -> None:
            for case in listed:
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
