"""What cannot be meant is one line on standard error, exit code 2, and nothing else: nothing is solved or written."""

from collections.abc import Iterator
from pathlib import Path

import pytest

import sinuous as sn
from sinuous.cli.app import main
from sinuous.cli.options import Output
from tests.cli.conftest import GOAL, PROBLEMS, ROBOT, START, TARGET
from tests.helpers import refused

RATES = "rates: {bend: 0.1, length: 0.05}\n"
MOVING = (
    "scene: [{sphere: {center: [0, 0, 0], radius: 0.4, name: ball, moving: [[0, [0, 0, 2.2]], [4, [0, 3, 2.2]]]}}]\n"
)

FILES = PROBLEMS | {
    "rates.yaml": ROBOT + START + GOAL + RATES,
    "moving.yaml": ROBOT + START + GOAL + MOVING,
    "accelerated.yaml": ROBOT + START + GOAL + MOVING + "rates: {bend: 1, acceleration: {bend: [1, 2]}}\n",
    "goes.yaml": ROBOT + TARGET + MOVING,
    "start_of_path.yaml": ROBOT + START + "path: [{position: [1, 0, 2]}]\n",
    "far_goal.yaml": ROBOT + START + "goal: [[0, 0, 9], [0, 0, 1], [0, 0, 1]]\n",
    "itself.yaml": "robot: itself.yaml\n",
    "targets.csv": "x,y,z\n0,0,2\n",
    "rows.csv": "no rows\n",
    "no": "",
}

ANY = {
    "--method magic": "--method: unknown method 'magic'; expected one of newton",
    "--method opti_pat": "--method: unknown method 'opti_pat'; did you mean 'opti_path'?",
    "--option beta=1": "--option beta: unknown option; expected none",
    "--time nan": "--time: expected a number of at least 0, got nan",
    "--time -1": "--time: expected a number of at least 0, got -1",
    "--time long": "--time: expected a number, got 'long'",
    "--time": "--time: missing; expected a value\n",
    "--seed -1": "--seed: expected a whole number from 0",
    "--seed 1.5": "--seed: expected a whole number, got '1.5'",
    "--fast": "--fast: unknown option; ",
    "--metod dls": "--metod: unknown option; did you mean '--method'?",
    "--out /nowhere/results.jsonl": "--out: cannot be written: ",
    "--plot /nowhere/picture.png": "--plot: cannot be written: ",
    "--plot picture.txt": "--plot: expected a name that ends in .png, .svg, .pdf, .gif, .mp4, .html, ",
    "--plot no/x.html": "--plot: cannot be written: ",
    "--csv easy.yaml": "--csv: would overwrite a problem file; expected another file, got ",
    "--out -": "--out: is no file; expected the name of a file",
    "--clearance thick": "--clearance: expected a number of at least 0, or one a segment",
    "--clearance elbow=1": "--clearance: no segment is called 'elbow'; expected one of s1",
}
"""Options of `solve` and of `track`."""

SOLVE = {
    "bad.yaml": "bad.yaml: target.position: expected 3 finite numbers",
    "easy.yaml bad.yaml --json": "bad.yaml: target.position: expected 3 finite numbers",
    "missing.yaml": "missing.yaml: cannot be read: No such file or directory; expected the name of a file",
    "path.yaml": "path.yaml: path: is for track; expected target or targets, got 3",
    "plan.yaml": "plan.yaml: goal: is for plan; expected target or targets, got [[-0.5, ",
    "goes.yaml": "goes.yaml: scene: ball moves; expected obstacles that stand still, or track or plan",
    "easy.yaml --method opti_path --option beta=1": "--option beta: unknown option; expected one of",
    "easy.yaml --method opti_path --option sample=5": "--option sample: unknown option; did you mean 'samples'?",
    "easy.yaml --method opti_path --option samples=x": "--option samples: expected a whole number",
    "easy.yaml --method opti_path --option samples": "--option: not an option; expected KEY=VALUE",
    "easy.yaml --method opti_path --option cooling=2": "--option cooling: expected a number",
    "easy.yaml --all 2 --by door": "--by: expected route or shape, got 'door'\n",
    "easy.yaml --by route": "--by: is for --all; expected --all COUNT, too, got 'route'\n",
    "easy.yaml --why-time 3": "--why-time: is for --why; expected --why, too, got 3.0\n",
    "easy.yaml --why --why-time=-1": "--why-time: expected a number of at least 0, got -1.0\n",
    "easy.yaml --all 0": "--all: expected a whole number from 1 to 10000, got 0",
    "easy.yaml --all 10001": "--all: expected a whole number from 1 to 10000, got",
    "easy.yaml --all 3 --why": "--all: cannot be combined with --why; expected one of --all, --why, got 3\n",
}


def each(begin: str, ends: dict[str, str]) -> dict[str, str]:
    """Return whole calls that begin alike, and what is said of each."""
    return {f"{begin} {end}": said for end, said in ends.items()}


CALLS = {
    "solve": "FILE: missing; expected problem files, YAML or JSON\n",
    "new tendon": "FILE: missing; expected the file to write\n",
    "batch easy.yaml --targets targets.csv": "--out: missing; expected table of results to write: .csv",
    "slove a.yaml": "slove: unknown command; did you mean 'solve'?\n",
    "go a.yaml": "go: unknown command; expected one of solve, track, ",
    "view easy.yaml a b": "view: more than it takes; expected FILE, got 'a b'\n",
    "solve easy.yaml --json=3": "--json: takes no value; expected --json alone\n",
    **each("solve easy.yaml", ANY),
    **each("track easy.yaml", ANY),
    **each("solve", SOLVE),
    "track plan.yaml": "plan.yaml: goal: is for plan; expected target or targets, got [[-0.5, ",
    "track path.yaml --rate 10": "--rate: is for --csv; expected --csv FILE, too, got 10.0",
    "track path.yaml --csv q.csv --rate 0": "--rate: expected a number greater than 0, got 0.0",
    "track path.yaml --deviation 0": "--deviation: expected a number greater than 0, got 0.0",
    "plan easy.yaml": "easy.yaml: start: missing; expected where the motion begins",
    "plan start_of_path.yaml": "start_of_path.yaml: path: is for track; expected target or targets, got 1",
    "plan far_goal.yaml": "far_goal.yaml: goal: length of segment 1 is 7.8 beyond its limit; expected a configuration",
    "plan plan.yaml --shortcuts -1": "--shortcuts: expected ",
    "plan plan.yaml --timed": "plan.yaml: rates: missing, and --timed needs them; expected how fast the robot may be",
    "plan rates.yaml --blend 1": "--blend: is for --timed; expected --timed, too",
    "plan rates.yaml --timed --duration 3": "--duration: cannot be combined with --timed; expected one of",
    "plan rates.yaml --duration 0": "--duration: expected a number greater than 0",
    "plan rates.yaml --begin nan": "--begin: expected a finite number",
    "plan moving.yaml": "moving.yaml: rates: ",
    "plan accelerated.yaml": "accelerated.yaml: rates.acceleration.bend: ",
    **each(
        "batch easy.yaml --targets targets.csv --out out.csv",
        {
            "--engine gpu": "--engine: expected one of threads, processes",
            "--dask here": "--dask: expected tcp://HOST:PORT",
            "--dask local --engine processes": "--dask: cannot be combined with --engine",
            "--shard 3/2": "--shard: expected I/N",
            "--shard 0/2": "--shard: expected I/N",
            "--chunk 0": "--chunk: ",
            "--workers 0": "--workers: ",
            "--out out.txt": "--out: expected a name that ends in .csv",
            "--targets no.csv": "--targets: ",
            "--targets easy.yaml": "--targets: expected a name that ends in .csv",
            "--out no/where/out.csv": "--out: ",
        },
    ),
    **each(
        "explore easy.yaml --memory arm.npz",
        {
            "--rounds -1": "--rounds: ",
            "--spacing 0": "--spacing: ",
            "--workers 0": "--workers: ",
            "--engine steam": "--engine: ",
            "--time -1": "--time: ",
            "--memory easy.yaml": "--memory: ",
            "--memory no/arm.npz": "--memory: ",
        },
    ),
    **each(
        "reach easy.yaml",
        {
            "--spacing 0": "--spacing: ",
            "--directions -1": "--directions: ",
            "--workers 0": "--workers: ",
            "--time -1": "--time: ",
            "--out map.csv": "--out: expected a name that ends in .npz",
            "--out no/map.npz": "--out: ",
            "--plot map.doc": "--plot: ",
        },
    ),
    "calibrate none.yaml rows.csv": "none.yaml: cannot be read: ",
    "calibrate driven.yaml none.csv": "none.csv: cannot be read: ",
    "calibrate driven.yaml none.csv --plot errors.mp4": "--plot: expected a name that ends in .",
    "design none.yaml --plot front.mp4": "--plot: expected a name that ends in .",
    "calibrate itself.yaml rows.csv": "itself.yaml: robot: unknown key; expected one of segments",
    "view easy.yaml --html x.png": "--html: expected a name that ends in .html, got 'x.png'\n",
    "view bad.yaml": "bad.yaml: target.position",
    "view easy.yaml --host nowhere": "--host: expected an address like 127.0.0.1",
    "view easy.yaml --port 70000": "--port: expected less than or equal to 65535, got '70000'",
    "new robot arm.yaml": "KIND: expected one of tendon, pneumatic, insertion, inspection, got 'robot'",
    "new tendon nowhere/arm.yaml": "FILE: cannot be written: No such file or directory; expected a file that can be",
    "new tendon arm.json": "FILE: has comments, which JSON has not; expected a name that ends in .yaml, got 'arm.json'",
    "new tendon . --force": "FILE: is there already; expected a new file, or --force, got '.'",
    "new tendon easy.yaml": "FILE: is there already; expected a new file, or --force, got 'easy.yaml'\n",
    "warm --method magic": "--method: expected one of newton, ",
    "warm --profile --method magic": "--method: expected one of newton, ",
    "warm --clear --where": "--where: cannot be combined with --clear; expected one of --where, --clear, got",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All files, once: whatever is refused changes none of them."""
    folder = tmp_path_factory.mktemp("refusals")
    for name, text in FILES.items():
        (folder / name).write_text(text)
    sn.Robot.uniform(1, 0.1, max_bend=1.0, tendons=sn.Tendons(3, 0.005)).save(folder / "driven.yaml")
    return folder


def _contents(folder: Path) -> Iterator[tuple[str, bytes]]:
    yield from sorted((file.name, file.read_bytes()) for file in folder.iterdir())


def test_a_picture_of_an_unknown_kind_is_told_of_pages_too() -> None:
    refused("--plot", lambda: Output(plot=Path("picture.txt")).check([]), ".html, ")


@pytest.mark.parametrize("typed", CALLS)
def test_a_wrong_call_is_one_line(
    typed: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    before = list(_contents(folder))
    assert main(typed.split()) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    said = [line for line in captured.err.splitlines() if not line.startswith("note: ")]
    assert "\n".join(said).startswith(CALLS[typed].rstrip())
    assert len(said) == 1
    assert list(_contents(folder)) == before
