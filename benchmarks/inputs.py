"""`inputs`: files in every dialect, whole and broken, read right, refused, or noted; notes; and large meshes.

What a file means is known, for it is written here: shuffled columns, separators, decimal commas, counts, names, axes,
units in headers, kinds of numbers, points that were not seen, files that were cut off. A file that is read as other
geometry without a note is wrong, and so is any exception but an `InputError`.
"""

import io
import struct
import tempfile
import warnings
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stderr
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan
from benchmarks.places.solids import CORNERS, FACES, Surface, joined, ring_loft
from sinuous.base.checks import Floats
from sinuous.problem.problem import problem_warnings
from sinuous.studies.batch.tables.reading import open_source
from sinuous.studies.calibration.measurements import read_table as read_measured

FILES = 5000
"""Files of a whole run."""

ALIKE = 2e-3
"""How far a point may be from where it was written, in units of the file: texts have few digits, some files 32 bits."""

AXES = ("x", "y", "z")


class Written(NamedTuple):
    """A file, and what it means.

    Attributes
    ----------
    name : str
    content : bytes
    points : ndarray (m, 3)
        Where all is that the file holds, z up; of a mesh its corners.
    options : dict
        How it is read.
    whole : bool
        Whether it must be read; one that is not whole may be refused, or noted.
    reader : callable
        From the file and the options to what it holds (m, k), and whether something was noted.
    """

    name: str
    content: bytes
    points: Floats
    options: dict[str, Any]
    whole: bool = True
    reader: Callable[..., tuple[Floats, bool]] | None = None


class Dialect(NamedTuple):
    """A text of columns, as some program might write it; rows (k,) whose own columns say nan; if it is whole.

    And what its other columns are called.
    """

    content: bytes
    lost: Any
    whole: bool
    beside: list[str]


OTHERS = ["id", "r", "g", "b", "nx", "intensity", "frame"]
"""Columns that may stand beside coordinates."""


def dialect(rng: Generator, columns: dict[str, Any], others: int, titled: bool, gaps: bool = True) -> Dialect:
    """Write columns, and some others, in one of many dialects: orders, separators, decimals, counts, cut off."""
    count = len(next(iter(columns.values())))
    form = str(rng.choice(["%.6f", "%.5e", "%.4f"]))
    beside = [str(each) for each in rng.choice(OTHERS, others, False)]
    asked, names = set(columns), [*columns, *beside]
    columns = columns | {name: np.arange(count) * (1.0 if name == "id" else 0.5) for name in beside}
    order = rng.permutation(len(names)) if titled else np.arange(len(names))
    separator = str(rng.choice([",", ";", "\t", " ", ", ", "   "]))
    comma = rng.random() < 0.3
    rows = [[form % columns[names[i]][k] for i in order] for k in range(count)]
    lost = np.flatnonzero(rng.random(count) < 0.2) if gaps and rng.random() < 0.2 else np.empty(0, np.intp)
    for k in lost:
        rows[k] = ["nan" if names[i] in asked else cell for i, cell in zip(order, rows[k], strict=True)]
    if comma:
        rows = [[cell.replace(".", ",") for cell in row] for row in rows]
    lines = [separator.join(row) for row in rows]
    if titled:
        said = [str(rng.choice([names[i], names[i].upper()])) if names[i] in AXES else names[i] for i in order]
        lines.insert(0, str(rng.choice(["", "#", "//", "# "] if gaps else ["", ""])) + separator.join(said))
    whole = not lost.size and not (comma and "," in separator)
    if rng.random() < 0.2:
        wrong = int(rng.random() < 0.3)
        lines.insert(int(titled and lines[0][:1] in "#/"), str(len(rows) + wrong))
        whole = whole and not wrong
    text = str(rng.choice(["\n", "\r\n"])).join(lines) + "\n"
    if rng.random() < 0.1:
        text, whole = text[: int(rng.integers(1, len(text)))], False
    return Dialect(text.encode("utf-16" if gaps and rng.random() < 0.05 else "utf-8"), lost, whole, beside)


MOTORS = ["s1.1", "s1.2", "s1.3"]


def tabled(
    names: Sequence[str],
    others: int,
    titles: float,
    rng: Generator,
    reader: Callable[..., tuple[Floats, bool]] | None = None,
) -> Written:
    """A text of rows, in what share of the cases with titles; other names than of axes are said by `columns=`."""
    points = rng.normal(scale=100.0, size=(int(rng.integers(3, 30)), len(names)))
    columns: dict[str, Any] = dict(zip(names, points.T, strict=True))
    titled, gaps, axes = rng.random() < titles, reader is None, list(names) == list(AXES)
    own = dialect(rng, columns, int(rng.integers(0, others + 1)), titled, gaps)
    ending = str(rng.choice(["csv", "txt", "xyz", "pts", "asc", "tsv"])) if gaps and axes else "csv"
    options = _dropped() if gaps else {}
    if gaps and not axes:
        options["columns"] = list(names) if titled else [1, 2, 3]
    whole = own.whole and not (reader is _read_batch and "nx" in own.beside)  # a third of a direction: it is refused
    return Written(f"rows.{ending}", own.content, np.delete(points, own.lost, axis=0), options, whole, reader)


def _read_path(file: Path, **_: Any) -> tuple[Floats, bool]:
    problem = file.with_name("problem.yaml")
    problem.write_text(f"robot: {{segments: {{count: 3, length: 1}}}}\npath: {file.name}\n")
    return np.array([targets[0].position for targets in sn.load(problem, sn.Job).waypoints]), False


def _read_batch(file: Path, **_: Any) -> tuple[Floats, bool]:
    source = open_source(file)
    try:
        read = source.read(0, source.rows)
    finally:
        source.close()
    kept = np.isfinite(read["positions"]).all(axis=1)
    return read["positions"][kept], not kept.all()


def _read_measured(file: Path, **_: Any) -> tuple[Floats, bool]:
    found = read_measured(file, MOTORS)
    rows = np.concatenate([found.measured, found.actuators], axis=1)
    return rows[np.isfinite(rows).all(axis=1)], not np.isfinite(rows).all()


def live(rng: Generator) -> Written:
    """A cloud as it comes from a sensor: any kind of number, some not seen, or nothing at all."""
    points = _cloud(rng)[: int(rng.integers(0, 30))].astype(str(rng.choice(["f4", "f8", ">f4"])))
    if rng.random() < 0.3:
        points = np.asfortranarray(points)
    content, reader = points.astype("<f8").tobytes(), partial(_see, points)
    return Written("live", content, _finite(points.astype(float)), {}, reader=reader)


def _see(points: Any, _: Path, **__: Any) -> tuple[Floats, bool]:
    scene = sn.Scene([sn.PointCloud([(1e6, 1e6, 1e6)], 1.0, name="seen")])
    scene.update(points, name="seen", invalid="drop")
    cloud: Any = scene.snapshot().obstacles[0]
    return cloud.points, False


def las(rng: Generator) -> Written:
    """A LAS or LAZ file: scales, offsets, kinds of points, withheld ones, and a unit."""
    import laspy  # noqa: PLC0415

    points, kind = _cloud(rng), int(rng.choice([0, 3, 6, 7]))
    points = _finite(points)
    header = laspy.LasHeader(point_format=kind, version="1.4" if kind > 5 else "1.2")
    header.scales, header.offsets = rng.choice([1e-3, 1e-4], 3), rng.normal(scale=1e3, size=3).round(2)
    if rng.random() < 0.5:
        unit = str(rng.choice(['UNIT["metre",1]', 'UNIT["foot",0.3048]']))
        header.vlrs.append(
            laspy.vlrs.known.WktCoordinateSystemVlr(f'PROJCS["a",GEOGCS["b",UNIT["degree",0.0175]],{unit}]')
        )
    own = laspy.LasData(header)
    own.x, own.y, own.z = points.T
    withheld = rng.random(len(points)) < (0.2 if rng.random() < 0.3 else 0.0)
    own.withheld = withheld
    file = io.BytesIO()
    own.write(file, do_compress=(compressed := bool(rng.random() < 0.3)))
    content = bytes(file.getbuffer())
    return _cut(rng, Written(f"scan.{'laz' if compressed else 'las'}", content, points[~withheld], {"radius": 1.0}))


def threemf(rng: Generator) -> Written:
    """A 3MF file: a box, perhaps within a component, each placed by itself."""
    corners, faces = _box(rng)
    places = "".join("<vertex x='{:.6f}' y='{:.6f}' z='{:.6f}'/>".format(*p) for p in corners)
    sides = "".join("<triangle v1='{}' v2='{}' v3='{}'/>".format(*f) for f in faces)
    unit = str(rng.choice(["", "unit='inch'", "unit='millimeter'", "unit='meter'"]))
    turns = [(np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(scale=10.0, size=3)) for _ in range(2)]
    said = [" ".join(f"{x:.9f}" for x in (*turn.ravel(), *shift)) for turn, shift in turns]
    for turn, shift in turns:
        corners = corners @ turn + shift
    model = (
        f"<model {unit} xmlns='http://schemas.microsoft.com/3dmanufacturing/core/2015/02'><resources>"
        f"<object id='1'><mesh><vertices>{places}</vertices><triangles>{sides}</triangles></mesh></object>"
        f"<object id='2'><components><component objectid='1' transform='{said[0]}'/></components></object></resources>"
        f"<build><item objectid='2' transform='{said[1]}'/></build></model>"
    )
    kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as parts:
        parts.writestr(
            "_rels/.rels", f"<Relationships><Relationship Target='/3D/a.model' Id='a' Type='{kind}'/></Relationships>"
        )
        parts.writestr("3D/a.model", model)
    return _cut(rng, Written("part.3mf", file.getvalue(), corners, {"scale": 1.0}))


def _columns(points: Floats, rng: Generator, other: str) -> tuple[list[str], Floats, bytes]:
    """Names of coordinates and one more column, in any order; the columns (m, 4); and these as text."""
    names = [str(each) for each in rng.permutation([*AXES, other])]
    columns = np.stack([points[:, AXES.index(n)] if n in AXES else np.ones(len(points)) for n in names], axis=1)
    return names, columns, "".join(" ".join(f"{x:.6f}" for x in row) + "\n" for row in columns).encode()


def ply(rng: Generator) -> Written:
    """A PLY file of points, as text or binary, with properties in any order."""
    points, kind = _cloud(rng), str(rng.choice(["ascii", "binary_little_endian", "binary_big_endian"]))
    names, columns, text = _columns(points, rng, "quality")
    data = text if kind == "ascii" else columns.astype((">" if "big" in kind else "<") + "f4").tobytes()
    head = "".join(f"property float {name}\n" for name in names)
    header = f"ply\nformat {kind} 1.0\nelement vertex {len(points)}\n{head}end_header\n".encode()
    return _cut(rng, Written("scan.ply", header + data, _finite(points), _dropped()))


def pcd(rng: Generator) -> Written:
    """An organised PCD file, as text or binary, with fields in any order."""
    points, kind = _cloud(rng), str(rng.choice(["ascii", "binary"]))
    names, columns, text = _columns(points, rng, "intensity")
    size = int(rng.choice([4, 8]))
    data = text if kind == "ascii" else columns.astype(f"<f{size}").tobytes()
    fields = f"FIELDS {' '.join(names)}\nSIZE {' '.join([str(size)] * 4)}\nTYPE F F F F\nCOUNT 1 1 1 1\n"
    head = f"# .PCD v0.7\nVERSION 0.7\n{fields}WIDTH {len(points)}\nHEIGHT 1\nPOINTS {len(points)}\nDATA {kind}\n"
    return _cut(rng, Written("scan.pcd", head.encode() + data, _finite(points), _dropped()))


def npy(rng: Generator) -> Written:
    """An NPY file of points, of any kind of number."""
    kind = str(rng.choice(["f4", "f8", ">f8", "i2", "i8", "f2"]))
    points = _cloud(rng).astype(kind) if kind[-2] == "f" else rng.integers(-999, 999, (20, 3)).astype(kind)
    with tempfile.TemporaryFile() as file:
        np.save(file, np.asfortranarray(points) if rng.random() < 0.5 else points)
        file.seek(0)
        content = file.read()
    return _cut(rng, Written("scan.npy", content, _finite(points.astype(float)), _dropped()))


def stl(rng: Generator) -> Written:
    """An STL file, as text or binary, with a header that may say axes or units."""
    import trimesh  # noqa: PLC0415

    corners, faces = _box(rng)
    said = str(rng.choice(["", "SPACE=LPS", "UNITS=mm"], p=[0.6, 0.2, 0.2]))
    text, end = rng.random() < 0.5, str(rng.choice(["endsolid", "end solid", "ENDSOLID part"]))
    box: Any = trimesh.Trimesh(corners, faces, process=False).export(file_type="stl_ascii" if text else "stl")
    if text:
        _, _, facets = box.partition("\n")
        content = f"solid part {said}\n{facets.replace('endsolid', end)}\n".encode()
    else:
        content = said.encode().ljust(80) + box[80:]
    return _cut(rng, Written("part.stl", content, corners, {"scale": 1.0}))


def of_trimesh(ending: str, rng: Generator) -> Written:
    """A mesh that trimesh writes; in a GLB file y is up, unless told otherwise."""
    import trimesh  # noqa: PLC0415

    corners, faces = _box(rng)
    y_up = ending == "glb"
    own = corners[:, [0, 2, 1]] * (1.0, 1.0, -1.0) if y_up else corners
    content: Any = trimesh.Trimesh(own, faces, process=False).export(file_type=ending)
    content = content.encode() if isinstance(content, str) else content
    return _cut(rng, Written(f"part.{ending}", content, corners, {"scale": 1.0}))


KINDS: dict[str, Callable[[Generator], Written]] = {
    "tables": partial(tabled, AXES, 3, 0.7),
    "tables with columns=": partial(tabled, ["east", "north", "up"], 2, 0.5),
    "paths": partial(tabled, AXES, 0, 1.0, reader=_read_path),
    "batches": partial(tabled, AXES, 2, 1.0, reader=_read_batch),
    "measured rows": partial(tabled, [*AXES, *MOTORS], 2, 1.0, reader=_read_measured),
    "live clouds": live,
    "las": las,
    "3mf": threemf,
    "ply of points": ply,
    "pcd": pcd,
    "npy": npy,
    "stl": stl,
    "obj": partial(of_trimesh, "obj"),
    "ply of a mesh": partial(of_trimesh, "ply"),
    "glb": partial(of_trimesh, "glb"),
}


def _cloud(rng: Generator) -> Floats:
    points = rng.normal(scale=100.0, size=(int(rng.integers(3, 30)), 3))
    points[rng.random(len(points)) < (0.3 if rng.random() < 0.3 else 0.0)] = np.nan
    return points


def _box(rng: Generator) -> tuple[Floats, Any]:
    return (CORNERS + 0.5) * rng.uniform(1.0, 50.0, 3) + rng.normal(scale=50.0, size=3), FACES


def _finite(points: Floats) -> Floats:
    return points[np.isfinite(points).all(axis=1)]


def _dropped() -> dict[str, Any]:
    return {"radius": 1.0, "invalid": "drop"}


def _cut(rng: Generator, own: Written) -> Written:
    """The same file, or in one of ten cases one that was cut off."""
    if rng.random() > 0.1:
        return own
    return own._replace(content=own.content[: int(rng.integers(1, len(own.content)))], whole=False)


def read(own: Written, folder: Path) -> str:
    """What becomes of a file: `right`, `noted`, `refused`, `refused whole`, `wrong` or `exception`."""
    file = folder / own.name
    file.write_bytes(own.content)
    kind: Any = sn.Mesh if "scale" in own.options else sn.PointCloud
    noted = False
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            if own.reader is not None:
                places, noted = own.reader(file, **own.options)
            else:
                found = kind.load(file, **own.options)
                places, noted = (found.vertices, bool(found.defects)) if kind is sn.Mesh else (found.points, False)
        except sn.InputError:
            return "refused whole" if own.whole and len(own.points) else "refused"
        except Exception:
            return "exception"
    noted = noted or bool(said)
    wanted = own.points
    if kind is sn.PointCloud and not own.whole:  # what a text that was cut off has lost cannot be known
        wanted, places = wanted[: max(0, len(places) - 1)], places[:-1]
    if len(places) == len(wanted) and bool((_gaps(places, wanted) < ALIKE).all()):
        return "right"
    return "noted" if noted else "wrong"


def _gaps(places: Floats, points: Floats) -> Floats:
    if places.shape[1:] != points.shape[1:]:
        return np.full(len(points), np.inf)
    gaps: Floats = np.linalg.norm(points[:, None] - places[None], axis=2).min(axis=1, initial=np.inf)
    return gaps


def read_all(kind: str, plan: Plan) -> Iterator[Line]:
    """Read files of a kind, a fourth of all if these are tables, and count what becomes of them."""
    files = plan.count(FILES, 400) // 4 if kind == "tables" else 3 * plan.count(FILES, 400) // (4 * len(KINDS) - 4)
    found: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(files):
            found[read(KINDS[kind](plan.rng(number, list(KINDS).index(kind))), Path(folder))] += 1
    for key, what in (("wrong", "other geometry without a note"), ("exception", "an exception but InputError")):
        yield Line(kind, f"{what}, of {files} files", float(found[key]), "files", Goal(0.0, correctness=True))
    told = ", ".join(f"{found[key]} {key}" for key in ("right", "noted", "refused", "refused whole"))
    yield Line(kind, "read right", 100.0 * found["right"] / files, "%", note=told)


ARMS = 60
"""Arms of which one number is wrong, for each kind of mistake; ten times as many are right, and seventeen again."""

LENGTHS = {"tendons": (0.002, 0.03), "limit": (0.01, 0.06), "radius": (0.002, 0.02), "tool": (0.005, 0.2)}
"""Least and largest of an arm of 0.3 m, in metres."""

ANGLES = ("max_bend", "rest", "angles")
"""What is given in degrees where it is wrong."""

OBSTACLES = ("box", "mesh", "cloud")

WRONG = (*LENGTHS, "target", "path", *OBSTACLES, *ANGLES, "mass", "stiffness")
"""What is in another unit than all else."""


def arm(rng: Generator, wrong: str = "") -> tuple[sn.Robot, sn.Scene, list[list[sn.Target]]]:
    """An arm of 0.3 m, what is around it, and where it is to go, in one unit of length, but for what is `wrong`."""
    metre = float(rng.choice([1.0, 100.0, 1000.0, 1.0 / 0.0254]))
    other = 1000.0 if metre < 50.0 else 1e-3
    factor = {key: other if key == wrong else 1.0 for key in (*LENGTHS, "target", "path", *OBSTACLES)}
    size = {key: float(np.exp(rng.uniform(*np.log(ends)))) for key, ends in LENGTHS.items()}
    size["limit"] = max(size["limit"], 2.0 * size["tendons"])
    own = {key: value * metre * factor[key] for key, value in size.items()}
    angles = {key: float(np.degrees(1.0)) if key == wrong else 1.0 for key in ANGLES}
    places, limits = np.array([0.0, 2.1, 4.2]) * angles["angles"], (-own["limit"], own["limit"])
    lines = sn.Tendons(angles=places, radius=own["tendons"], displacement=limits)
    soft = 2e-3 * metre**3 * (1e6 if wrong == "stiffness" else 1.0)
    mass = 0.05 / metre * (1e3 if wrong == "mass" else 1.0)
    segment = sn.Segment(0.1 * metre, 1.5 * angles["max_bend"], radius=own["radius"], tendons=lines)
    segment = segment.changed(rest=(0.4 * angles["rest"], 0.0), stiffness=soft, mass=mass)
    tool = np.eye(4)
    tool[2, 3] = own["tool"]
    robot = sn.Robot([segment] * 3, tool=tool, gravity=(0.0, 0.0, -9.81 * metre))
    far = np.array([0.4, 0.1, 0.2]) * metre
    corners, faces = _box(rng)
    unit = (corners - corners.min(axis=0)) / np.ptp(corners, axis=0).max()
    box = sn.Box(far * factor["box"], np.full(3, 0.1 * metre * factor["box"]))
    mesh = sn.Mesh((far + 0.2 * metre * unit) * factor["mesh"], faces)
    points = (far + 0.1 * metre * rng.random((20, 3))) * factor["cloud"]
    scene = sn.Scene([box, mesh, sn.PointCloud(points, 0.002 * metre * factor["cloud"])])
    place = np.array([0.1, 0.0, 0.2]) * metre
    along = [place] if wrong == "target" else [place * share for share in np.linspace(0.9, 1.1, 5)]
    return robot, scene, [[sn.Target(each * factor["target"] * factor["path"])] for each in along]


def suspicious(plan: Plan) -> Iterator[Line]:
    """Count what is noted of right problems, which should be nothing, and of wrong ones, which should be all."""
    count = plan.count(17 * ARMS, ARMS)
    said = sum(bool(_said(plan.rng(0, number))) for number in range(count))
    yield Line("notes", f"of {count} right problems", float(said), "noted", Goal(0.0, correctness=True))
    for i, wrong in enumerate(WRONG):
        missed = ARMS - sum(bool(_said(plan.rng(1 + i, number), wrong)) for number in range(ARMS))
        yield Line("notes", f"of {ARMS} arms with {wrong} in another unit", float(missed), "not noted", Goal(0.0))
    files = sorted(Path(__file__).parents[1].joinpath("examples").glob("*.yaml"))
    noted = [
        file.name
        for file in files
        if (job := sn.load(file, sn.Job)) and problem_warnings(job.robot, job.scene.snapshot(), job.waypoints)
    ]
    yield Line("notes", f"of {len(files)} examples", float(len(noted)), "noted", Goal(0.0), note=", ".join(noted))


def _said(rng: Generator, wrong: str = "") -> list[str]:
    robot, scene, waypoints = arm(rng, wrong)
    return problem_warnings(robot, scene.snapshot(), waypoints)


MANY, HUGE, BODIES, SIDES_OF_BODY = 300_000, 2_600_000, 1000, 320
"""Triangles of a large mesh and of a huge one; bodies of a file, and triangles of each."""


def bumpy(count: int) -> Surface:
    """A torus with bumps, of about so many triangles."""
    turn = np.linspace(0.0, 2.0 * np.pi, int(np.sqrt(count / 2)), endpoint=False)
    u, v = np.meshgrid(turn, turn, indexing="ij")
    r = 30.0 + 3.0 * np.sin(7 * u) * np.cos(5 * v)
    around = 100.0 + r * np.cos(v)
    return ring_loft(np.stack([around * np.cos(u), around * np.sin(u), r * np.sin(v)], axis=-1))


def bodies() -> Surface:
    """Balls on a grid."""
    import trimesh  # noqa: PLC0415

    ball = trimesh.creation.icosphere(2)
    places = 3.0 * np.stack(np.meshgrid(*[np.arange(10.0)] * 3), axis=-1).reshape(-1, 3)
    return joined([Surface(ball.vertices + place, ball.faces) for place in places])


def large(plan: Plan) -> Iterator[Line]:
    """Load large meshes from binary STL and prepare them for solving, with nothing kept from before."""
    sizes: list[tuple[str, Callable[[], Surface], Goal | None]] = [
        (f"{MANY:,} triangles", partial(bumpy, MANY), Goal(3.0)),
        (f"{BODIES:,} bodies of {SIDES_OF_BODY} triangles", bodies, Goal(5.0)),
        (f"{HUGE:,} triangles", partial(bumpy, HUGE), None),
    ]
    _load(bumpy(2000))  # compiled
    for what, made, goal in sizes[: plan.count(3, 2)]:
        cpu, wall, told = _load(made())
        note = f"{wall:.1f} s by the clock; told before: {told or 'nothing'}"
        yield Line("large meshes", f"{what}: loaded and prepared, CPU", cpu, "s", goal, note=note)


def _load(surface: Surface) -> tuple[float, float, str]:
    """Seconds of CPU and of the clock, and what was told of how long it takes."""
    triangles = np.zeros(len(surface.faces), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    triangles["corners"] = (surface.vertices + perf_counter() % 1.0)[surface.faces]  # else samples may be kept
    with tempfile.TemporaryDirectory() as folder, redirect_stderr(io.StringIO()) as told:
        file = Path(folder, "large.stl")
        file.write_bytes(b" " * 80 + struct.pack("<I", len(triangles)) + triangles.tobytes())
        cpu, wall = process_time(), perf_counter()
        sn.Scene([sn.Mesh.load(file, 1.0)]).snapshot().prepare()
        return process_time() - cpu, perf_counter() - wall, " and ".join(told.getvalue().splitlines())


PARTS: dict[str, Part] = {kind: partial(read_all, kind) for kind in KINDS} | {
    "notes": suspicious,
    "large meshes": large,
}
"""What is measured, by name."""
