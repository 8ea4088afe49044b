"""One map for all tests that only look at it."""

import pytest

import sinuous as sn
from tests.studies.workspace.maps import made


@pytest.fixture(scope="session")
def found() -> sn.studies.Reach:
    return made(workers=3)


@pytest.fixture(scope="session")
def positions() -> sn.studies.Reach:
    return made(directions=0)
