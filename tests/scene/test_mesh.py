"""Meshes: what is a solid and what a shell, what is mended and said, files of every kind, and bad input."""

import io
import sys
import zipfile
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.obstacles import measure
from sinuous.scene import mesh_files, triangles
from tests.helpers import NOT_NUMBERS, present, random_rotation, refused, refused_each, with_each
from tests.scene.shapes import ball, cube, inverted, soup, together, torus

trimesh = pytest.importorskip("trimesh")

OPEN = (cube()[0], cube()[1][1:])


def volume(mesh: sn.Mesh) -> float:
    return triangles.enclosed_volume(mesh.vertices, mesh.faces)


def test_a_closed_mesh_is_a_solid() -> None:
    mesh = sn.Mesh(*cube(2.0), name="die")
    assert mesh.watertight
    assert mesh.defects == ()
    assert volume(mesh) == pytest.approx(8.0)
    assert mesh.name == "die"
    assert mesh.vertices.dtype == np.float64
    assert mesh.faces.dtype == np.int64
    assert not mesh.vertices.flags.writeable
    assert not mesh.faces.flags.writeable
    assert sn.Mesh(*cube(), inside=True).inside


def test_a_soup_of_triangles_is_sewn_together() -> None:
    mesh = sn.Mesh(*soup(ball()))
    assert mesh.watertight
    assert mesh.defects == ()
    assert len(mesh.vertices) == len(ball()[0])
    signed_zero = soup(cube())
    signed_zero[0][::2] *= np.where(signed_zero[0][::2] == 0.0, -1.0, 1.0)
    assert sn.Mesh(*signed_zero).watertight


def test_holes_make_a_shell() -> None:
    mesh = sn.Mesh(*OPEN, thickness=0.1)
    assert not mesh.watertight
    assert mesh.thickness == 0.1
    (defect,) = mesh.defects
    assert defect == "3 edges with one triangle only (holes), so it is used as a shell and not as a solid"
    assert len(mesh.faces) == 11


@pytest.mark.parametrize(
    ("body", "turned", "size"),
    [
        (inverted(cube()), 12, 1.0),
        (together(cube(), inverted(cube(0.5, (3, 0, 0)))), 12, 1.125),
        (together(inverted(cube()), inverted(cube(0.5, (3, 0, 0)))), 24, 1.125),
        (together(inverted(cube()), cube(0.5)), 24, 0.875),
    ],
)
def test_bodies_that_face_inwards_are_turned(body: Any, turned: int, size: float) -> None:
    mesh = sn.Mesh(*body)
    assert mesh.watertight
    assert mesh.defects == (f"{turned} triangles faced inwards and were turned",)
    assert volume(mesh) == pytest.approx(size)


@pytest.mark.parametrize("seed", range(3))
def test_triangles_against_their_neighbours_are_turned(seed: int) -> None:
    vertices, faces = together(ball(), inverted(cube(0.5)), cube(1.0, (4, 0, 0)))
    wrong = np.random.default_rng(seed).random(len(faces)) < 0.2
    mixed = np.where(wrong[:, None], faces[:, ::-1], faces)
    mesh = sn.Mesh(vertices, mixed)
    assert mesh.watertight
    assert volume(mesh) == pytest.approx(volume(sn.Mesh(vertices, faces)))
    assert mesh.defects == (f"{wrong.sum()} triangles faced another way than the neighbours and were turned",)


def test_triangles_without_area_are_dropped_and_said() -> None:
    vertices, faces = cube()
    lines = np.concatenate([faces, [[0, 0, 1], [3, 3, 3]]])
    mesh = sn.Mesh(vertices, lines)
    assert mesh.watertight
    assert mesh.defects == ("2 triangles without area dropped",)
    sliver = sn.Mesh([[0, 0, 0], [1, 0, 0], [0.3, 1e-14, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 3]])
    assert len(sliver.faces) == 1
    assert len(sliver.vertices) == 3
    assert sliver.defects[0] == "1 triangle without area dropped"


@pytest.mark.parametrize("kind", ["stl", "ply", "obj", "glb"])
def test_files_of_every_kind(tmp_path: Path, kind: str) -> None:
    turn, body = random_rotation(np.random.default_rng(1)), ball(1)
    file = tmp_path / f"ball.{kind}"
    trimesh.Trimesh(*body, process=False).export(file)
    mesh = sn.Mesh.load(file, 2.0, position=(1, 2, 3), rotation=turn, name="ball", up="z")
    assert mesh.watertight
    assert mesh.defects == ()
    assert mesh.scale == 2.0
    assert mesh.name == "ball"
    expected = 2.0 * body[0] @ turn.T + (1, 2, 3)
    gaps = np.linalg.norm(mesh.vertices[:, None] - expected, axis=-1)
    assert gaps.min(axis=0).max() < 1e-6
    assert len(mesh.vertices) == len(expected)


def test_all_bodies_of_a_scene_are_used_where_they_stand(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    part = trimesh.Trimesh(*cube(), process=False)
    scene.add_geometry(part, transform=trimesh.transformations.translation_matrix((5, 0, 0)))
    scene.add_geometry(part, transform=trimesh.transformations.translation_matrix((0, 3, 0)))
    file = tmp_path / "parts.glb"
    scene.export(file)
    mesh = sn.Mesh.load(file, 1)  # y is up in the file: (x, y, z) of it is (x, -z, y)
    assert mesh.watertight
    assert len(mesh.faces) == 24
    np.testing.assert_allclose(mesh.vertices.min(axis=0), (-0.5, -0.5, -0.5), atol=1e-6)
    np.testing.assert_allclose(mesh.vertices.max(axis=0), (5.5, 0.5, 3.5), atol=1e-6)
    assert mesh.defects[0].startswith("y is up in such a file, so it was turned to have z up")


@pytest.mark.parametrize("kind", ["stl", "ply", "obj", "glb"])
def test_the_axis_that_is_up_is_turned_to_z(tmp_path: Path, kind: str) -> None:
    file = tmp_path / f"part.{kind}"
    trimesh.creation.box((1, 2, 3)).export(file)
    asked: tuple[Literal["y", "z"] | None, ...] = (None, "y", "z")
    sizes = [np.ptp(sn.Mesh.load(file, 1, up=up).vertices, axis=0).round(6).tolist() for up in asked]
    turned, kept = [1.0, 3.0, 2.0], [1.0, 2.0, 3.0]
    assert sizes == [turned if kind == "glb" else kept, turned, kept]
    assert sn.Mesh.load(file, 1, up="y").source.arguments["up"] == "y"  # type: ignore[union-attr]
    refused("up", lambda: sn.Mesh.load(file, 1, up="x"), "y or z")  # type: ignore[arg-type]


def model(text: str) -> bytes:
    """A 3MF file with this model."""
    link = f'<Relationship Target="/3D/3dmodel.model" Id="a" Type="{mesh_files.MODEL_PART}"/>'
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as parts:
        parts.writestr("_rels/.rels", f"<Relationships>{link}</Relationships>")
        parts.writestr("3D/3dmodel.model", text.replace("<model", f"<model xmlns='{mesh_files.MODEL[1:-1]}'"))
    return file.getvalue()


def test_3mf_is_built_as_it_says(tmp_path: Path) -> None:
    """Against the reader of trimesh: components within components, placed and mirrored, and a unit."""
    vertices, faces = cube()
    points = "".join("<vertex x='{}' y='{}' z='{}'/>".format(*p) for p in vertices)
    corners = "".join("<triangle v1='{}' v2='{}' v3='{}'/>".format(*f) for f in faces)
    text = f"""<model unit='inch'><resources>
    <object id='1'><mesh><vertices>{points}</vertices><triangles>{corners}</triangles></mesh></object>
    <object id='2'><components><component objectid='1' transform='1 0 0 0 0 1 0 -1 0 3 0 0'/>
    <component objectid='1' transform='-1 0 0 0 1 0 0 0 1 0 5 0'/></components></object></resources>
    <build><item objectid='2' transform='0 1 0 -1 0 0 0 0 1 7 8 9'/><item objectid='1'/></build></model>"""
    file = tmp_path / "part.3mf"
    file.write_bytes(model(text))
    mesh, expected = sn.Mesh.load(file, 2.0), trimesh.load_scene(file).to_geometry()
    assert mesh.defects[0] == "its unit is the inch; its lengths were multiplied by scale, and by nothing else"
    assert volume(mesh) == pytest.approx(3 * 8.0)
    gaps = np.linalg.norm(mesh.vertices[:, None] - 2.0 * expected.vertices, axis=-1)
    assert gaps.min(axis=0).max() < 1e-12
    assert gaps.min(axis=1).max() < 1e-12
    whole = model(text)
    for content, wanted in (
        (whole[:200], "cannot be read: File is not a zip file"),
        (model(text.replace("<item objectid='1'/>", "<item objectid='7'/>")), "cannot be read"),
        (model(text.replace("objectid='1' transform='-1", "objectid='2' transform='-1")), "within themselves"),
        (model(text.replace("v1='0'", "v1='99'")), "a vertex that is not there"),
        (model(text.replace("<model", "<model requiredextensions='p'")), "requires the extensions p"),
        (model("<model><build/></model>"), "builds no triangles"),
    ):
        file.write_bytes(content)
        refused("file", lambda: sn.Mesh.load(file, 1.0), wanted)


def test_what_comments_say_of_units_and_axes_is_noted(tmp_path: Path) -> None:
    for kind, line in (("obj", "# File units = millimeters"), ("ply", "comment up: y")):
        text = trimesh.creation.box().export(file_type=kind, **({"encoding": "ascii"} if kind == "ply" else {}))
        lines = (text if isinstance(text, str) else text.decode()).splitlines()
        lines.insert(2, line)
        (tmp_path / f"a.{kind}").write_text("\n".join(lines) + "\n")
        assert "which changed nothing" in sn.Mesh.load(tmp_path / f"a.{kind}", 1).defects[0]


FACET = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n"


def test_stl_files_say_what_is_wrong_with_them(tmp_path: Path) -> None:
    def load(content: bytes | str) -> sn.Mesh:
        (tmp_path / "part.stl").write_bytes(content.encode() if isinstance(content, str) else content)
        return sn.Mesh.load(tmp_path / "part.stl", 1)

    for text in (
        "solid a\n" + FACET + "end solid a\n",
        "solid\n" + FACET.replace("endfacet", "end facet") + "ENDSOLID",
    ):
        assert len(load(text).faces) == 1, text
    whole = trimesh.creation.box().export(file_type="stl")
    assert load(b"SPACE=LPS UNIT=mm".ljust(80) + whole[80:]).defects == (
        "its header says SPACE=LPS and UNIT=mm, which changed nothing: coordinates are as they stand",
    )
    assert len(load(whole + b"more").faces) == 12
    for content, told in (
        (whole[:-70], "truncated: its header says 12 triangles, which need 684 bytes, and it has 614"),
        (whole[:40], "truncated: it has 40 bytes"),
        (b"", "is empty"),
        (bytes(84), "holds no triangles"),
        (bytes(84) + whole[84:], "its header says 0 triangles, and there are more"),
        ("solid a\n" + FACET, "truncated: the text ends in facet 1"),
        ("solid a\n" + FACET + FACET[:40], "truncated: the text ends in facet 2"),
    ):
        refused("file", partial(load, content), told)


def test_wrong_arrays_are_refused() -> None:
    vertices, faces = cube()
    refused("vertices", lambda: sn.Mesh(vertices[:, :2], faces), "shape (8, 2); ")
    refused("vertices", lambda: sn.Mesh([], faces), "at least one point")
    refused("vertices", lambda: sn.Mesh("cube", faces))  # type: ignore[arg-type]
    refused(
        "vertices[3]",
        lambda: sn.Mesh(np.where(np.arange(8)[:, None] == 3, np.nan, vertices), faces),
        "3 finite numbers",
    )
    refused("vertices[0]", lambda: sn.Mesh(1e200 * vertices, faces), "too large")
    refused("faces", lambda: sn.Mesh(vertices, []), "at least one triangle")
    refused("faces", lambda: sn.Mesh(vertices, np.zeros((0, 3), int)), "at least one triangle")
    refused("faces", lambda: sn.Mesh(vertices, faces[:, :2]), "shape (12, 2); ")
    refused("faces", lambda: sn.Mesh(vertices, faces.astype(float)), "whole numbers from 0 to 7")
    refused("faces", lambda: sn.Mesh(vertices, [[0, 1], [2]]))
    refused("faces[1]", lambda: sn.Mesh(vertices, [[0, 1, 2], [0, 1, 8]]), "[0, 1, 8]", "0 to 7")
    refused("faces[0]", lambda: sn.Mesh(vertices, [[0, 1, -1]]), "[0, 1, -1]", "not there")
    refused("faces", lambda: sn.Mesh(vertices, [[0, 1, 1]]), "without area")


def test_wrong_options_are_refused() -> None:
    refused_each("thickness", [*NOT_NUMBERS, -1.0], lambda value: sn.Mesh(*OPEN, thickness=value))
    refused("thickness", lambda: sn.Mesh(*cube(), thickness=0.1), "open meshes", "a solid")
    refused("inside", lambda: sn.Mesh(*OPEN, inside=True), "watertight", "3 edges with one triangle only (holes)")
    refused("inside", lambda: sn.Mesh(*cube(), inside=1), "true or false")  # type: ignore[arg-type]


def test_wrong_files_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "charset_normalizer", None)  # where it is there, trimesh finds some text anywhere

    def load(name: str, content: bytes = b"", scale: Any = 1.0) -> Any:
        file = tmp_path / name
        file.write_bytes(content)
        return lambda: sn.Mesh.load(file, scale)

    refused("file", lambda: sn.Mesh.load(tmp_path / "none.stl", 1), "No such file")
    refused("file", load("cube.step"), "ends in .stl, .ply, .obj, .3mf, .glb")
    for name in ("a.stl", "a.ply", "a.obj", "a.glb"):
        for content in (b"", b"This is no mesh\n", bytes(range(256))):
            refused("file", load(name, content))
    refused(
        "file",
        load("cut.stl", b"cut".ljust(80) + b"\x09\x00\x00\x00" + bytes(range(200))),
        "truncated: its header says 9",
    )
    refused("file", load("cut.ply", b"ply\nformat binary_little_endian 1.0\n" + bytes(range(200))))
    refused("file", load("cut.obj", b"v 0 0 0\nv 1 0 0\nv 0 1"), "cannot be read")
    refused("file", load("points.obj", b"v 0 0 0\nv 1 0 0\n"), "at least one triangle")
    refused_each("scale", [*NOT_NUMBERS, 0.0, -1.0], lambda value: load("a.obj", b"", value)())
    with pytest.raises(TypeError, match="scale"):
        sn.Mesh.load(tmp_path / "a.obj")  # type: ignore[call-arg]


def test_without_trimesh_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "a.obj"
    file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    monkeypatch.setitem(sys.modules, "trimesh", None)
    refused("file", lambda: sn.Mesh.load(file, 1.0), "needs trimesh", "pip install sinuous[mesh]")
    assert len(sn.Mesh(*cube()).faces) == 12


@with_each(("size", "fits"), [(1e-4, False), (0.01, True), (1.0, True), (400.0, True), (2000.0, False)])
def test_a_scale_that_cannot_be_meant_is_refused(size: float, fits: bool) -> None:
    mesh = sn.Mesh(*cube(size))
    if fits:
        mesh.check_size(1.0)
    else:
        refused("vertices", lambda: mesh.check_size(1.0), "the unit of the robot")


@with_each("count", [1, 2, 3, 8])
@with_each("share", [0.5, 0.3])
def test_slivers_leave_a_solid_closed(count: int, share: float) -> None:
    """Where a triangle has more corners along a side than the one beside it, slivers fill the gap of no width."""
    turn = random_rotation(np.random.default_rng(0))
    vertices, faces = cube()[0] @ turn.T, cube()[1]
    for _ in range(count):
        a, b, c = faces[0].tolist()
        new = len(vertices)
        vertices = np.concatenate([vertices, [share * vertices[a] + (1.0 - share) * vertices[b]]])
        faces = np.concatenate([[[a, new, c], [new, b, c], [a, b, new]], faces[1:]])
    mesh = sn.Mesh(vertices, faces)
    assert mesh.watertight
    assert volume(mesh) == pytest.approx(1.0)
    assert mesh.defects[0].startswith(f"{count} triangle")
    assert len(mesh.defects) == 1
    assert triangles.are_triangles(mesh.vertices, mesh.faces).all()


@pytest.mark.parametrize("most", [0.01, 0.1])
def test_decimation_never_claims_more_room(most: float) -> None:
    """Its margin holds by libigl, and every distance to it is at most that to the mesh as it was, by libigl, too."""
    igl = pytest.importorskip("igl")
    pytest.importorskip("fast_simplification")
    rng = np.random.default_rng(3)
    mesh = sn.Mesh(*torus(1.0, count=(40, 40), bumps=0.03))
    fewer = mesh.decimated(most)
    assert len(fewer.faces) < 0.8 * len(mesh.faces)
    assert fewer.watertight
    assert "were decimated to" in fewer.defects[0]
    corners = mesh.vertices[mesh.faces]
    places = np.einsum("fkx,fsk->fsx", corners, rng.dirichlet([0.5] * 3, (len(corners), 12))).reshape(-1, 3)
    moved = np.sqrt(igl.point_mesh_squared_distance(places, fewer.vertices, fewer.faces)[0].max())
    assert 0.5 * moved < moved <= fewer.margin <= most
    points = np.concatenate([rng.uniform(-1.6, 1.6, (500, 3)), places[:500] + rng.normal(scale=most, size=(500, 3))])
    before = np.sqrt(igl.point_mesh_squared_distance(points, mesh.vertices, mesh.faces)[0])
    before *= np.where((igl.fast_winding_number(mesh.vertices, mesh.faces, points) > 0.5), -1.0, 1.0)
    scene = sn.Scene([fewer]).snapshot()
    assert (scene.distance(points) <= before + 1e-12).all()
    np.testing.assert_allclose(scene.distance(points), measure(fewer, points), atol=1e-9)


def test_decimation_in_files_is_said_and_kept(tmp_path: Path) -> None:
    pytest.importorskip("fast_simplification")
    trimesh.Trimesh(*torus(1.0, count=(30, 30), bumps=0.03), process=False).export(tmp_path / "a.ply")
    mesh = sn.Mesh.load(tmp_path / "a.ply", 10.0, decimate=1.0)
    assert present(mesh.source).arguments["decimate"] == 1.0
    assert 0.0 < mesh.margin <= 1.0
    assert mesh._box[1, 0] >= mesh.vertices[:, 0].max() + mesh.margin
    assert mesh.decimated(1e-9) is mesh
    refused("decimate", lambda: sn.Mesh(*torus(1.0), inside=True).decimated(1.0), "the body stays out of")
    refused_each("decimate", (0.0, -1.0, "a"), lambda value: sn.Mesh.load(tmp_path / "a.ply", 1.0, decimate=value))
