"""Write each piece of Python of the README and the cookbook into a file of a folder, for a type checker.

`python -m tests.user_code.shown FOLDER`, and then `mypy FOLDER`.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = (ROOT / "README.md", ROOT / "docs" / "cookbook.md")


def main() -> None:
    """Write the files; those of one page are numbered."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for page in PAGES:
        for i, code in enumerate(re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)):
            (folder / f"{page.stem}_{i}.py").write_text(code, encoding="utf-8")


if __name__ == "__main__":
    main()
