"""Classes of routes: their words, and there and back as plain values."""

import json

import pytest

from sinuous.answer.route_class import Passing, RouteClass
from sinuous.base.errors import InputError
from tests.cases import with_each

PILLAR = Passing("pillar", "-y", (1.0, 2.5, 1e-3))
WALL = Passing("wall", None, (12.3456, 0.0, -80.0))


def test_words() -> None:
    assert str(RouteClass(1, ())) == "class 1: the only one found"
    assert str(RouteClass(2, (PILLAR,))) == "class 2: past pillar on its -y side"
    assert str(RouteClass(3, (PILLAR, WALL))) == (
        "class 3: past pillar on its -y side and through wall at [12.3, 0, -80]"
    )
    assert str(RouteClass(4, (PILLAR,) * 7)).endswith("past pillar on its -y side and 3 more")


@pytest.mark.parametrize("passes", [(), (PILLAR,), (WALL, PILLAR)])
def test_plain_values_there_and_back(passes: tuple[Passing, ...]) -> None:
    own = RouteClass(3, passes)
    assert RouteClass.from_dict(json.loads(json.dumps(own.to_dict()))) == own


GOOD = {"number": 1, "passes": [{"obstacle": "wall", "side": None, "at": [0, 0, 1]}]}


@with_each(
    ("values", "message"),
    [
        (3, "expected a mapping with number, passes, got 3"),
        ({"number": 1}, "expected a mapping with number, passes"),
        (GOOD | {"number": 0}, "number: expected a whole number from 1"),
        (GOOD | {"passes": 1}, "passes: expected a list, got 1"),
        (GOOD | {"passes": [1]}, r"passes\[0\]: expected a mapping with obstacle, side, at, got 1"),
        (GOOD | {"passes": [GOOD["passes"][0] | {"side": "left"}]}, r"passes\[0\].side: expected one of -x, \+x"),  # type: ignore[index]
        (GOOD | {"passes": [GOOD["passes"][0] | {"at": [0, 1]}]}, r"passes\[0\].at: expected"),  # type: ignore[index]
        (GOOD | {"passes": [GOOD["passes"][0] | {"obstacle": 3}]}, r"passes\[0\].obstacle: expected"),  # type: ignore[index]
    ],
)
def test_what_is_no_class_is_refused_by_its_key(values: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        RouteClass.from_dict(values)
