"""How quickly a motion is played."""

LONGEST, SHORTENED = 30.0, 20.0
"""A motion that takes longer than the first is played in so many seconds as the second."""


def pace(duration: float) -> float:
    """Return how much of a motion's time passes in a second of playing.

    Times are taken for seconds, unless the whole would take more patience than people have.
    """
    return 1.0 if duration <= LONGEST else duration / SHORTENED
