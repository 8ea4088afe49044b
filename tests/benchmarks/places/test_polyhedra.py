"""The published protocols are as published."""

import numpy as np

from benchmarks.places import make
from benchmarks.places.polyhedra import SCENES


def test_scenes_are_those_of_the_protocol() -> None:
    assert {name: (len(centers), radius) for name, centers, radius in SCENES} == {
        "octahedron": (6, 0.4),
        "cube": (8, 0.4),
        "icosahedron": (12, 0.4),
        "lattice": (27, 0.2),
    }
    for name, centers, _ in SCENES:
        assert len({tuple(center) for center in centers}) == len(centers)
        if name == "icosahedron":
            np.testing.assert_allclose(np.linalg.norm(centers, axis=1), 1.0, atol=1e-4)
            gaps = np.linalg.norm(np.array(centers)[:, None] - np.array(centers), axis=-1)
            assert ((gaps > 0.1).sum(axis=1) == 11).all()
            np.testing.assert_allclose(np.sort(gaps, axis=1)[:, 1:6], 1.0514, atol=1e-3)


def test_fixed_robots_are_asked_for_full_poses_and_none_repeats() -> None:
    made = [make("p3", seed) for seed in range(40)]
    assert all(place.target.rotation is not None for place in made)
    assert all((place.hidden_q[:, 2] == 1.0).all() for place in made)
    assert len({tuple(np.array(place.target.position)) for place in made}) == 40
    assert len({id(place.scene) for place in made}) == 4


def test_extensible_robots_have_three_to_six_segments_in_every_scene() -> None:
    made = [make("p4 direction", seed) for seed in range(16)]
    assert len({(len(place.robot), id(place.scene)) for place in made}) == 16
    assert {len(place.robot) for place in made} == {3, 4, 5, 6}
    assert all(place.target.direction is not None for place in made)
    assert all(make("p4 pose", seed).target.rotation is not None for seed in range(4))
    lengths = np.concatenate([place.hidden_q[:, 2] for place in made])
    assert 0.15 <= lengths.min() < 0.25
    assert 0.45 < lengths.max() <= 0.55


def test_directions_of_bends_are_drawn_on_their_own() -> None:
    """Published code drew bends and their planes from one key, so that one was twice the other."""
    q = np.concatenate([make("p3", seed).hidden_q for seed in range(60)])
    bends, angles = np.hypot(q[:, 0], q[:, 1]), np.arctan2(q[:, 1], q[:, 0])
    off = np.abs(np.exp(1j * angles) - np.exp(2j * bends))
    assert (off > 0.1).mean() > 0.8
