"""The rates that hold a target back are those that bring it nearer when they are greater."""

from functools import cache

import numpy as np
import pytest

import sinuous as sn
from sinuous.model.rates import Changes

N = 5
ARM = sn.Robot.uniform(N, (45, 70), max_bend=2.4, radius=4, tendons=sn.Tendons(3, radius=4))


@cache
def free_solver() -> sn.Solver:
    """Not made when tests are collected, since that compiles."""
    return sn.Solver(ARM)


KEYS = {"bend_rate": "bend", "length_rate": "length", "actuator_rate": "actuator"}

Most = dict[str, np.ndarray]


def short_of(seed: int, most: Most) -> tuple[np.ndarray, sn.Target, sn.Solution]:
    """A solve that its changes leave short: the target is as far away as they lead, and half as far again."""
    rng = np.random.default_rng(seed)
    q = np.column_stack([rng.normal(0.0, 0.4, (N, 2)), rng.uniform(50.0, 65.0, N)])
    toward = rng.normal(0.0, 1.0, 3)
    tip = ARM.tip(q)[:3, 3]
    far = free_solver().solve(sn.Target(tip + 1000.0 * toward), q, within=Changes(**most))
    target = sn.Target(tip + 1.5 * (ARM.tip(far.q)[:3, 3] - tip) + rng.normal(0.0, 0.2, 3))
    return q, target, free_solver().solve(target, q, within=Changes(**most))


@pytest.mark.parametrize("seed", range(8))
def test_a_rate_is_named_when_more_of_it_would_help(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    most = {"bend": rng.uniform(0.005, 0.05, N), "length": rng.uniform(0.1, 2.0, N)}
    if seed % 2:
        most["actuator"] = rng.uniform(0.02, 0.2, len(ARM.actuators))
    q, target, found = short_of(seed, most)
    assert found.status is sn.Status.RATE_BOUND
    assert found.binding
    off = found.position_error or 0.0
    gains = {}
    for key, own in most.items():
        for i in range(len(own)):
            more = {name: each.copy() for name, each in most.items()}
            more[key][i] *= 1.2
            gains[key, i] = off - (free_solver().solve(target, q, within=Changes(**more)).position_error or 0.0)
    largest = max(gains.values())
    names = [actuator.name for actuator in ARM.actuators]
    named = {
        (KEYS[each.constraint], names.index(each.actuator) if each.actuator else int(each.segment or 0) - 1)
        for each in found.binding
        if each.constraint in KEYS
    }
    assert largest > 0.0
    assert {which for which, gain in gains.items() if gain > 0.02 * largest} <= named
    assert all(gains[which] > -0.02 * largest for which in named)
    for each in found.binding:
        if each.constraint in KEYS:
            assert each.value == pytest.approx(each.limit, rel=3e-3)


def test_what_rates_leave_is_no_rate() -> None:
    """A length at its limit is named as that, however much it might change."""
    q = np.tile([0.0, 0.0, 70.0], (N, 1))
    found = free_solver().solve(sn.Target((0, 0, 380)), q, within=Changes(bend=0.01, length=1.0))
    assert {each.constraint for each in found.binding} == {"length"}


def test_more_changes_are_the_remedy() -> None:
    q, target, found = short_of(3, {"bend": np.full(N, 0.02), "length": np.full(N, 0.5)})
    told = str(found.explain(30.0))
    assert "change of the length of" in told
    (remedy,) = found.explain(30.0).remedies
    assert remedy.change == "within"
    assert free_solver().solve(target, q, within=Changes(0.02, 0.5) * remedy.after).solved
    assert not free_solver().solve(target, q, within=Changes(0.02, 0.5) * (0.95 * remedy.after)).solved
