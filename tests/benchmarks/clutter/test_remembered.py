"""What remembered starts bring: a short run counts as it should, and targets are feasible."""

import numpy as np
import pytest

from benchmarks.clutter.remembered import main, measured, targets_about
from benchmarks.places import make
from benchmarks.places.place import feasible


def test_targets_are_feasible_and_differ() -> None:
    place = make("spheres 12", 3)
    others = list(targets_about(place, 5, np.random.default_rng(0)))
    assert len(others) == 5
    assert all(feasible(other) and not np.allclose(other.hidden_q, place.hidden_q) for other in others)


def test_a_place_is_solved_with_a_memory_and_without() -> None:
    row = measured("pipe 1.3", 2, 4)
    assert (row.targets, row.solved, row.solved_without, row.wrong, row.remembered) == (4, 4, 4, 0, 4)
    assert row.kept >= 1


def test_the_command_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--piece", "spheres 12", "--count", "2", "--alone"]) == 0
    assert "| spheres 12 | 2 | 2, 2 | 0 |" in capsys.readouterr().out


@pytest.mark.parametrize("typed", [["--count", "0"], ["--piece", "hop"], ["--seed", "-1"]])
def test_what_cannot_be_meant_is_refused_in_one_line(typed: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(typed) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
