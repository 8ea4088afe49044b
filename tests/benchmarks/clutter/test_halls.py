"""The route search alone."""

from benchmarks.clutter.halls import measure
from benchmarks.harness.plan import Plan
from benchmarks.places import make
from benchmarks.places.traps.cells import in_frame
from sinuous.scene.obstacles import Box


def test_a_hall_is_a_thousand_radii_wide() -> None:
    hall = make("hall", 0)
    (back,) = [box for box in hall.scene.obstacles if box.name == "hall back"]
    assert isinstance(back, Box)
    assert (back.size[:2] >= 999.0 * max(hall.robot.radii)).all()
    assert (abs(in_frame(hall.robot.base, back.center[None])) < 2000.0 * max(hall.robot.radii)).all()


def test_time_and_memory_are_said() -> None:
    median, memory = measure(Plan(quick=True))
    assert median.solved is not None
    assert median.solved[1] == 2
    assert median.reached > 0.0
    assert 0.1 < memory.reached < 200.0
