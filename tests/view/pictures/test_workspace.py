"""Pictures of a map are files that can be looked at."""

import sys
from pathlib import Path

import pytest

import sinuous as sn
from tests.helpers import refused
from tests.studies.workspace.maps import ROBOT, WALL


def test_picture_and_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sn.view.plot_reach(sn.studies.reach(ROBOT, None, 60.0, 2), tmp_path / "map.png", at=(0, 0, 60))
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    found = sn.studies.reach(ROBOT, WALL, 60.0, 2)
    sn.view.plot_reach(found, tmp_path / "map.html")
    page = (tmp_path / "map.html").read_text(encoding="utf-8")
    assert "data:image/png" in page
    assert "reachable" in page
    refused("point", lambda: sn.view.plot_reach(found, tmp_path / "map.png", at=(1e4, 0, 0)), "outside the map")
    refused("file", lambda: sn.view.plot_reach(found, tmp_path / "map.doc"), "ends in")
    for name in ("matplotlib", "matplotlib.backend_bases"):
        monkeypatch.setitem(sys.modules, name, None)
    refused("file", lambda: sn.view.plot_reach(found, tmp_path / "map.png"), "needs Matplotlib; expected it installed")
