"""Tests of the fields of the panel: what a person puts there is neither lost nor taken back."""

import asyncio
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import pytest

from sinuous.view.page.panel import Fields


class Handle:
    """A field of a browser, without the browser."""

    label = "a number"

    def __init__(self, value: float) -> None:
        self.value = value
        self._hear: Any = None

    def on_update(self, hear: Callable[[Any], object]) -> None:
        self._hear = hear

    def put(self, value: float) -> None:
        """Change the value as a browser does."""
        self.value = value
        asyncio.run(self._hear(SimpleNamespace(client=object())))


class Model:
    """A number that is at most 9; its events wait until they are handled."""

    def __init__(self) -> None:
        self.number, self._events = 1.0, list[Callable[[], object]]()
        self.handle = Handle(self.number)
        self.fields = Fields(cast(Any, None), cast(Any, self))
        self.fields.field(self.handle, self.get, self.put)
        self.meanwhile: Callable[[], object] = lambda: None

    def get(self) -> float:
        number = self.number
        self.meanwhile()
        return number

    def put(self, value: float) -> None:
        if value > 9.0:
            raise ValueError("at most 9")
        self.number = value

    def do(self, key: str, change: Callable[[], object]) -> None:
        assert key
        self._events.append(change)

    def handled(self) -> None:
        for event in self._events:
            event()


def test_what_a_person_puts_there_stays_until_it_is_handled() -> None:
    model = Model()
    model.handle.put(3.0)
    model.fields.refresh()
    assert (model.handle.value, model.number) == (3.0, 1.0)
    model.handled()
    model.fields.refresh()
    assert (model.handle.value, model.number) == (3.0, 3.0)


def test_what_a_person_puts_there_while_fields_are_refreshed_is_not_lost() -> None:
    model = Model()
    model.meanwhile = lambda: model.handle.put(4.0)
    model.fields.refresh()
    model.meanwhile = lambda: None
    model.handled()
    model.fields.refresh()
    assert (model.handle.value, model.number) == (4.0, 4.0)


def test_what_was_refused_vanishes() -> None:
    model = Model()
    model.handle.put(10.0)
    with pytest.raises(ValueError, match="at most 9"):
        model.handled()
    model.fields.refresh()
    assert (model.handle.value, model.number) == (1.0, 1.0)
