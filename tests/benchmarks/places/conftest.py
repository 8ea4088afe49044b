"""Fewer samples of distances: here places are made and looked at, and nothing is solved in them."""

from collections.abc import Iterator

import pytest

from sinuous.scene import sampling


@pytest.fixture(autouse=True, scope="package")
def _few_samples() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sampling, "LEAST", 2**14)
        patch.setattr(sampling, "MOST", 2**14)
        yield
