"""What a process that measures does not say."""

import warnings

from sinuous.base.errors import SuspiciousInput


def ignore_suspicions() -> None:
    """Keep warnings of suspicious input to ourselves: random problems are odd on purpose."""
    warnings.simplefilter("ignore", SuspiciousInput)
