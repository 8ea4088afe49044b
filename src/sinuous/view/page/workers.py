"""Worker threads with event queues, in which an event replaces an older one of the same kind."""

import threading
from collections.abc import Callable, Hashable

Event = Callable[[], object]
"""What is to be done; it runs in the thread of the worker."""

IDLE = 0.08
"""Seconds without a new event after which a worker is idle."""


def _nothing() -> None:
    """Do nothing."""


class Worker:
    """A thread that handles events in the order in which they were posted.

    An event replaces one under the same key that has not begun; so of many moves of a target only the latest is
    handled.

    Parameters
    ----------
    name : str
    failed : callable
        Called with every exception of an event.
    after : callable, optional
        Called when all events that were in the queue are handled.
    idle : callable, optional
        Called once when no event came for a while after that.
    """

    def __init__(
        self,
        name: str,
        failed: Callable[[Exception], object],
        after: Event = _nothing,
        idle: Event = _nothing,
    ) -> None:
        self._failed, self._after, self._idle = failed, after, idle
        self._queue: dict[Hashable, Event] = {}
        self._condition = threading.Condition()
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name=f"sinuous-{name}", daemon=True)
        self._thread.start()

    def post(self, key: Hashable, event: Event) -> None:
        """Put an event at the end of the queue; returns at once."""
        with self._condition:
            self._queue.pop(key, None)
            self._queue[key] = event
            self._condition.notify()

    def stop(self) -> None:
        """End after the event that is handled now; wait for that."""
        with self._condition:
            self._stopped = True
            self._condition.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _run(self) -> None:
        busy = False
        while True:
            with self._condition:
                if not self._queue and not self._stopped:
                    self._condition.wait(IDLE if busy else None)
                if self._stopped:
                    return
                events, self._queue = list(self._queue.values()), {}
            if events:
                for event in events:
                    self._try(event)
                self._try(self._after)
            elif busy:
                self._try(self._idle)
            busy = bool(events)

    def _try(self, event: Event) -> None:
        try:
            event()
        except Exception as error:
            self._failed(error)
