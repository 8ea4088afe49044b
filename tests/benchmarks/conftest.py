"""Brief looks at how fast the machine is: nothing here depends on it."""

from collections.abc import Iterator

import pytest

from benchmarks.harness import reference


@pytest.fixture(autouse=True, scope="package")
def _brief_looks() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reference, "REPEATS", 5)
        yield
