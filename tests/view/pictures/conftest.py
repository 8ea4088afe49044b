"""What several tests of pictures draw."""

import pytest

import sinuous as sn
from tests.view.pictures.arms import BALL, PATH, ROBOT


@pytest.fixture(scope="package")
def track() -> sn.Motion:
    return sn.track(ROBOT, PATH, BALL)
