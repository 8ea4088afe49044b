"""Triangles for tests, made by hand: a cube, a ball, and several bodies as one; and obstacles of all kinds."""

from collections.abc import Callable

import numpy as np

import sinuous as sn
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.triangles import Integers
from tests.helpers import Floats

Triangles = tuple[Floats, Integers]


def cube(size: float = 1.0, center: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Triangles:
    """Eight vertices and twelve triangles, counterclockwise as seen from outside."""
    vertices = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)], np.float64) - 0.5
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    return size * vertices + np.array(center), np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])


def ball(rounds: int = 2) -> Triangles:
    """Approximate the unit ball by an octahedron, the triangles of which are cut in four again and again."""
    vertices = np.concatenate([np.eye(3), -np.eye(3)])
    faces = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])
    for _ in range(rounds):
        corners = vertices[faces]
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = a + b, b + c, c + a
        soup = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
        soup /= np.linalg.norm(soup, axis=-1, keepdims=True)
        vertices, flat = np.unique(soup.reshape(-1, 3).round(12), axis=0, return_inverse=True)
        faces = flat.reshape(-1, 3)
    return vertices, faces.astype(np.int64)


def torus(radius: float, thick: float = 0.3, count: tuple[int, int] = (24, 12), bumps: float = 0.0) -> Triangles:
    """A surface in one piece, which cuts through itself where it is thicker than its ring is wide; a little rough."""
    a, b = np.meshgrid(*(np.linspace(0.0, 2.0 * np.pi, n, endpoint=False) for n in count), indexing="ij")
    thickness = thick + bumps * np.sin(7 * a) * np.cos(5 * b)
    ring = radius + thickness * np.cos(b)
    places = np.stack([ring * np.cos(a), ring * np.sin(a), thickness * np.sin(b)], axis=-1).reshape(-1, 3)
    here = np.arange(a.size).reshape(a.shape)
    next_a, next_b = np.roll(here, -1, axis=0), np.roll(here, -1, axis=1)
    both = np.roll(next_a, -1, axis=1)
    faces = [np.stack(each, axis=-1).reshape(-1, 3) for each in ((here, next_a, both), (here, both, next_b))]
    return places + 1e-3 * np.random.default_rng(0).uniform(-1.0, 1.0, places.shape), np.concatenate(faces)


def together(*bodies: Triangles) -> Triangles:
    """Several bodies in one pair of arrays."""
    first = np.cumsum([0, *(len(vertices) for vertices, _ in bodies)])
    faces = [faces + start for (_, faces), start in zip(bodies, first, strict=False)]
    return np.concatenate([vertices for vertices, _ in bodies]), np.concatenate(faces)


def inverted(body: Triangles) -> Triangles:
    return body[0], body[1][:, ::-1]


def obj(body: Triangles) -> str:
    """Text of an OBJ file."""
    vertices, faces = body[0].tolist(), (body[1] + 1).tolist()
    return "\n".join(f"{kind} {a} {b} {c}" for kind, rows in (("v", vertices), ("f", faces)) for a, b, c in rows)


def soup(body: Triangles) -> Triangles:
    """Triangles that share no vertices, as in an STL file."""
    return body[0][body[1]].reshape(-1, 3), np.arange(body[1].size).reshape(-1, 3)


def away(points: Floats) -> Floats:
    """How far points are from a ball about the origin."""
    return np.asarray(np.linalg.norm(points, axis=-1)) - 0.5


def sampled_ball() -> sn.Grid:
    places = np.moveaxis(np.indices((7, 7, 7)), 0, -1) * 0.3 - 0.9
    return sn.Grid(away(np.asarray(places, np.float64)), (-0.9, -0.9, -0.9), 0.3)


TURN = (0.9, 0.1, 0.3, 0.2)
EACH_KIND: dict[str, Callable[[], Obstacle]] = {
    "sphere": lambda: sn.Sphere((0.2, 0.3, 1.0), 0.5, name="lamp"),
    "sphere around": lambda: sn.Sphere((0.2, 0.3, 1.0), 3.0, inside=True, name="dome"),
    "box": lambda: sn.Box((0.5, 0.0, 0.5), (0.4, 0.6, 0.8), TURN, name="crate"),
    "room": lambda: sn.Box((0.5, 0.0, 0.5), (4, 6, 8), TURN, inside=True),
    "capsule": lambda: sn.Capsule((0, 0, 1), (1, 0, 2), 0.3),
    "capsule without length": lambda: sn.Capsule((0, 0, 1), (0, 0, 1), 0.3),
    "cylinder": lambda: sn.Cylinder((0, 0, 1), (1, 0.5, 2), 0.3),
    "drum": lambda: sn.Cylinder((0, 0, -5), (1, 0.5, 5), 4.0, inside=True),
    "half-space": lambda: sn.HalfSpace((0, 0, -1), (0.1, 0.2, 1)),
    "mesh": lambda: sn.Mesh(*cube(2.0)),
    "mesh around": lambda: sn.Mesh(*cube(2.0), inside=True, name="hall"),
    "plates": lambda: sn.Mesh(cube()[0], cube()[1][:3], thickness=0.2),
    "cloud": lambda: sn.PointCloud(np.random.default_rng(0).normal(size=(50, 3)), np.linspace(0.05, 0.3, 50)),
    "cells": lambda: sn.Grid(np.random.default_rng(0).random((4, 5, 6)) > 0.8, (0, 0, 0), 0.3),
    "samples": sampled_ball,
    "function": lambda: sn.Field(away, (-1, -1, -1), (1, 1, 1), 0.25),
}
"""Obstacles of every kind, within a few units of the origin, and rooms around them; each made anew."""
