import dataclasses
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from sinuous.methods.method import Options, choice, count, flag, number
from tests.helpers import NOT_NUMBERS, refused, refused_each


@dataclasses.dataclass(frozen=True)
class Sample(Options):
    method: ClassVar[str] = "sample"
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {"slow": {"rate": 0.1, "rounds": 1}}

    rate: float = number(0.5, above=0.0, high=2.0)
    rounds: int = count(3, 1, 10)
    metric: str = choice("second", ("first", "second"))
    careful: bool = flag(True)


def test_what_cannot_be_meant_is_refused() -> None:
    refused_each("rate", [*NOT_NUMBERS, 0.0, -1.0, 2.1], lambda x: Sample(rate=x))
    refused_each("rounds", [0, 11, 2.0, "2", True, None], lambda x: Sample(rounds=x))
    refused_each("metric", ["third", "", None, 1], lambda x: Sample(metric=x), "first or second")
    refused_each("careful", [1, 0, "true", None], lambda x: Sample(careful=x))


def test_options_are_read_as_they_are_typed() -> None:
    assert Sample.parse([]) == Sample()
    typed = Sample.parse(["rate=1e-1", "rounds=7", "metric=first", "careful=False"])
    assert typed == Sample(0.1, 7, "first", False)


def test_a_preset_gives_values_that_others_may_change() -> None:
    assert Sample.parse(["preset=slow"]) == Sample(rate=0.1, rounds=1)
    assert Sample.parse(["rounds=2", "preset=slow"]) == Sample(rate=0.1, rounds=2)
    refused("preset", lambda: Sample.parse(["preset=fast"]), "slow")


def test_what_is_typed_wrongly_is_refused() -> None:
    refused("rate", lambda: Sample.parse(["rate=fast"]))
    refused("rate", lambda: Sample.parse(["rate=nan"]))
    refused("rate", lambda: Sample.parse(["rate=1", "rate=1"]), "twice")
    refused("rounds", lambda: Sample.parse(["rounds=1.5"]))
    refused("careful", lambda: Sample.parse(["careful=maybe"]))
    refused("speed", lambda: Sample.parse(["speed=1"]), "one of rate, rounds, metric, careful, preset")
    refused("", lambda: Sample.parse(["rate"]), "KEY=VALUE")
    refused("rate", lambda: Options.parse(["rate=1"]), "has no options")


def test_a_kernel_sees_numbers_in_the_order_of_the_fields() -> None:
    np.testing.assert_array_equal(Sample().vector(), [0.5, 3.0, 1.0, 1.0])
    np.testing.assert_array_equal(Sample(2.0, 9, "first", False).vector(), [2.0, 9.0, 0.0, 0.0])
