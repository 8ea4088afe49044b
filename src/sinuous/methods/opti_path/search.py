"""The method of Sun & Wang, whole: a path of arcs from base to goal, improved until it is a shape of the robot.

The unknowns are the points where arcs meet. The last is the goal, so that the position is exact by construction; what
has to be reached is that all lengths lie in their ranges, that the tip points where it should, and that the body is
clear. The first path that the common check (see `sinuous.kernels.solve.judge`) calls solved ends the search.
"""

from numba.np.unsafe.ndarray import to_fixed_tuple

from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.maths.vectors import Array, get_vec
from sinuous.kernels.problem import Problem, read_robot
from sinuous.kernels.solve.driver import NO_START, Start, driver
from sinuous.kernels.solve.judge import Answer, Check, check_size
from sinuous.kernels.tables import DIRECTION, GOAL, METHOD_OPTIONS, MOUNT, ORIENTATION, TARGET_POSITION, UNIT, Budget
from sinuous.methods.opti_path.costs import Setting
from sinuous.methods.opti_path.improve import improve
from sinuous.methods.opti_path.path import Aim, Path, Work, want
from sinuous.methods.opti_path.potential import read_potential
from sinuous.methods.opti_path.starts import begin_path

OPTIONS = len(Setting._fields)


def workspace_size(segments: int, obstacles: int) -> int:
    """Numbers (float64) that a solve needs as workspace."""
    return 15 * (segments + 1) + 22 * segments + check_size(segments, obstacles)


@kernel
def carve_path(buffer: Array, n: int) -> tuple[Path, Array, Array]:
    """Lay out a path and a configuration in `buffer` (w,) for n segments; returns the rest of the buffer too."""
    m = 3 * (n + 1)
    rest = buffer[5 * m :]
    path = Path(
        buffer[:m].reshape((n + 1, 3)),
        buffer[m : 2 * m].reshape((n + 1, 3)),
        buffer[2 * m : 3 * m].reshape((n + 1, 3)),
        rest[: 15 * n].reshape((n, 15)),
        buffer[3 * m : 4 * m].reshape((n + 1, 3)),
        buffer[4 * m : 5 * m].reshape((n + 1, 3)),
        rest[15 * n : 19 * n].reshape((n, 4)),
    )
    return path, rest[19 * n : 22 * n].reshape((n, 3)), rest[22 * n :]


@kernel
def read_setting(options: Array) -> Setting:
    """Name the first 28 numbers of the `options`."""
    return Setting(*to_fixed_tuple(options, OPTIONS))  # type: ignore[call-arg]


@kernel
def read_aim(problem: Problem) -> Aim:
    """The target of the tip, and the mean length of a segment."""
    return Aim(
        get_vec(problem.targets, 0, TARGET_POSITION),
        get_vec(problem.targets, 0, GOAL),
        problem.targets[0, ORIENTATION] == DIRECTION,
        problem.unit / problem.limits.shape[0],
    )


@kernel
def follow(
    problem: Problem, check: Check, work: Work, options: Array, start: Start, answer: Answer
) -> tuple[int, bool]:
    """Follow one start; see `sinuous.kernels.solve.driver`. The `options` are in `work` already."""
    aim = read_aim(problem)
    source = begin_path(problem, check, work, aim, start)
    if source < 0:
        return NO_START, False
    return improve(problem, check, work, aim, source, answer)


drive = driver(follow)


@entry
def search(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    initial: Array,
    budget: Budget,
    workspace: Array,
    answers: Array,
) -> None:
    """Solve m problems, laid out as `driver` says; `workspace` (w,) is scratch, see `workspace_size`.

    The options in `settings` are those of `costs.Setting`, then what `potential.read_potential` takes apart.
    """
    n, options = int(robot[0]), settings[METHOD_OPTIONS:]
    setting, sampled = read_setting(options), options[OPTIONS:]
    path, q, rest = carve_path(workspace, n)
    want(read_robot(robot).limits, setting.dead_band, settings[MOUNT], path)
    work = Work(path, q, setting, read_potential(sampled, setting.slope, setting.influence * (settings[UNIT] / n)))
    drive(work, (robot, scene, settings), targets, initial, budget, rest, answers)
