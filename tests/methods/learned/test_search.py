"""The method `learned`: its kernel, its answers, its file, and what it refuses.

Training: what is learned, and what is refused.
"""

from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.cli.app import main
from sinuous.methods import learned
from sinuous.methods.learned import MOST_WIDTH, Learned
from tests.helpers import refused
from tests.methods import laws

KINDS = ("position", "direction", "rotation")


@cache
def network() -> sn.methods.Network:
    return sn.methods.train(laws.ARM, samples=2000, width=32, rounds=60)


@pytest.mark.parametrize("kind", KINDS)
def test_the_kernel_says_what_the_network_says(kind: str) -> None:
    own, targets = network(), laws.tip_targets(laws.ARM, 10, kind=kind)
    scratch, q = learned.Pass(np.empty(MOST_WIDTH), np.empty(MOST_WIDTH)), np.full((5, 3), np.nan)
    for target, shape in zip(targets, own.shapes(targets), strict=True):
        learned.predict(own.table(), target.table[0], scratch, q)
        np.testing.assert_allclose(q, shape, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_near_alone_and_meets_targets_with_steps(kind: str) -> None:
    targets = laws.tip_targets(laws.ARM, 60, kind=kind)
    alone = sn.Solver(laws.ARM, method=Learned(network(), steps=0)).solve_many(targets)
    assert np.median(alone.position_error) < 0.25 * laws.ARM.mean_length
    assert not alone.iterations.any()
    one = sn.Solver(laws.ARM, method=Learned(network(), steps=1)).solve_many(targets)
    assert np.median(one.position_error) < 0.35 * np.median(alone.position_error)
    solver = sn.Solver(laws.ARM, method=Learned(network()))
    assert laws.solved_and_verified(solver, targets) >= 58
    assert set(solver.solve_many(targets[:5]).start) == {"remembered"}


def test_the_same_seed_gives_the_same_network_and_another_one_another() -> None:
    own = [sn.methods.train(laws.ARM, samples=100, width=4, rounds=1, seed=seed) for seed in (0, 0, 1)]
    assert own[0].equals(own[1])
    assert repr(own[0]) == repr(own[1]) != repr(own[2])


def test_an_initial_configuration_comes_first_and_limits_are_kept() -> None:
    q = laws.shapes(laws.ARM, 1, 1.0, 0)[0]
    found = sn.Solver(laws.ARM, method=Learned(network())).solve(laws.ARM.tip(q), initial=q)
    assert (found.start, found.iterations) == ("given", 0)
    laws.does_not_pretend(Learned(network(), steps=1))


def test_the_file_brings_it_back_and_others_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "arm.npz"
    network().save(file)
    assert sn.methods.Network.load(file).equals(network())
    other = sn.Robot.uniform(4, (45, 70))
    refused("network", partial(sn.Solver, other, method=Learned(sn.methods.Network.load(file))), "another robot")
    assert sn.Solver(laws.ARM, method=Learned(network()), clearance=1.0)
    sn.Memory(laws.ARM).save(file)
    refused("network", partial(sn.methods.Network.load, file), "damaged")
    file.write_bytes(b"PK\3\4 nothing")
    refused("network", partial(sn.methods.Network.load, file), "damaged")
    refused("network", partial(sn.methods.Network.load, tmp_path / "none.npz"), "cannot be read")


def test_what_is_no_network_is_refused() -> None:
    refused("network", lambda: Learned("arm.npz"))  # type: ignore[arg-type]
    refused("steps", lambda: Learned(network(), steps=-1))
    refused("robot", lambda: sn.methods.Network("arm", []))  # type: ignore[arg-type]
    refused("layers", lambda: sn.methods.Network(laws.ARM, []))
    good = [list(each) for each in network().layers]
    refused(
        "layers[1][0]", lambda: sn.methods.Network(laws.ARM, [good[0], [np.zeros((3, 8)), np.zeros((9, 15))], good[2]])
    )
    refused("layers[0][0]", lambda: sn.methods.Network(laws.ARM, [[np.zeros((4, 14))], good[1], good[2]]))
    refused("len(layers[0])", lambda: sn.methods.Network(laws.ARM, [[], good[1], good[2]]))
    refused("target.position", lambda: network().shapes([sn.Target(direction=(0, 0, 1))]))


def test_the_command_trains_and_solves(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = str(tmp_path / "arm.yaml"), str(tmp_path / "arm.npz")
    sn.Job(laws.ARM, sn.Target((60, 20, -240))).save(file)
    assert main(["train", file, "--out", out, "--samples", "500", "--width", "16", "--rounds", "5"]) == 0
    assert capsys.readouterr().out.startswith(f"{out}: Network(5 segments, ")
    assert main(["solve", file, "--method", "learned", "--option", f"network={out}"]) == 0
    sn.Job(sn.Robot.uniform(4, 60), sn.Target((60, 20, 200))).save(file)
    capsys.readouterr()
    assert main(["solve", file, "--method", "learned", "--option", f"network={out}"]) == 2
    assert "of another robot" in capsys.readouterr().err
    assert main(["train", file, "--out", out, "--samples", "5"]) == 2
    assert "--samples" in capsys.readouterr().err


WALL = sn.HalfSpace((30, 0, 0), (-1, 0, 0))


def test_drawn_shapes_keep_the_limits() -> None:
    robot = sn.Robot([sn.Segment(length=(1, 2), max_bend=0.5), sn.Segment(length=1, max_curvature=0.3)])
    q = learned._draw(robot, 500, np.random.default_rng(0))
    bends = np.linalg.norm(q[:, :, :2], axis=-1)
    assert (bends.max(axis=0) <= (0.5, 0.3)).all()
    assert (bends.max(axis=0) > (0.45, 0.28)).all()
    assert q[:, 0, 2].min() < 1.05
    assert (q[:, 1, 2] == 1.0).all()


def test_among_obstacles_what_is_clear_is_learned() -> None:
    scene = sn.Scene([WALL])
    rows, shapes = learned._lessons(laws.ARM, scene, 0, 300, np.random.default_rng(0))
    assert len(rows) == len(shapes) >= learned.FEWEST_TARGETS
    assert rows[:, 0].max() < 30.0
    for q in shapes[:20].reshape(-1, 5, 3):
        assert laws.ARM.backbone(q)[..., 0].max() < 30.0


def test_where_nothing_is_clear_the_robot_alone_is_learned() -> None:
    rows, _ = learned._lessons(laws.ARM, sn.Scene([sn.Sphere((0, 0, 0), 500)]), 0, 300, np.random.default_rng(0))
    assert len(rows) > 200


def test_what_is_no_training_is_refused() -> None:
    refused("robot", lambda: sn.methods.train("arm"))  # type: ignore[arg-type]
    refused("samples", lambda: sn.methods.train(laws.ARM, samples=3))
    refused("width", lambda: sn.methods.train(laws.ARM, width=0))
    refused("rounds", lambda: sn.methods.train(laws.ARM, rounds=0))
    refused("seed", lambda: sn.methods.train(laws.ARM, seed=-1))
    heavy = sn.Robot([sn.Segment(length=1, mass=1)], gravity=(0, 0, -9.81), stiffness=sn.Stiffness(1.0))
    refused("gravity", lambda: sn.methods.train(heavy))
