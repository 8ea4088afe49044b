"""One change that makes a problem solvable."""

from dataclasses import dataclass
from typing import Any

from sinuous.reprs import ShortRepr
from sinuous.words import number


@dataclass(frozen=True, repr=False)
class Remedy(ShortRepr):
    """A change that was tried: with it, the problem is solved and proved.

    Attributes
    ----------
    change : str
        What is changed: `max_bend of all segments`, `target position`, `obstacle ball`, `time`.
    before, after : object
        Plain values; `None` after: it is taken away.
    note : str
        What else there is to say, like how far a target moves; may be empty.
    """

    change: str
    before: Any
    after: Any
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        return {"change": self.change, "from": self.before, "to": self.after}

    def __str__(self) -> str:
        note = f" ({self.note})" if self.note else ""
        if self.after is None:
            return f"without {self.change}{note}"
        before = "" if self.before is None else f"{number(self.before, 6)} -> "
        return f"{self.change}: {before}{number(self.after, 6)}{note}"
