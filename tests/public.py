"""All public names of the package, by what users write: `Robot`, `studies.reach`."""

from collections.abc import Iterator
from typing import Any

import sinuous as sn

ENTRANCES = (sn, sn.answer, sn.files, sn.methods, sn.studies, sn.view)


def public_names() -> Iterator[tuple[str, Any]]:
    """Yield every public name, as it stands behind `sn.`, and its value."""
    for entrance in ENTRANCES:
        for name in entrance.__all__:
            if name != "__version__":
                yield f"{entrance.__name__}.{name}".removeprefix("sinuous."), getattr(entrance, name)
