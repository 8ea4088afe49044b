"""Plans into narrow places are summed up."""

from benchmarks.motion.places.trials import Trial, lines_of


def test_what_has_no_start_does_not_count_and_what_is_late_is_missed() -> None:
    trials = [Trial(1.0, True, "solved", ""), Trial(6.0, True, "solved", ""), Trial(1.0, True, "solved", "obstacle")]
    planned, false = lines_of("x", trials, "planned", "false")
    assert planned.reached == 100.0 / 3
    assert false.reached == 1
    assert [line.reached for line in lines_of("x", [], "planned", "false")] == [0]
