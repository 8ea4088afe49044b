"""`python -m benchmarks many`: batches through files, on one worker and on several, killed and not; and a map."""

from benchmarks.harness.experiment import Part
from benchmarks.many import files, workers, workspace

PARTS: dict[str, Part] = {
    "files": files.measure,
    "workers": workers.measure,
    "deaths": files.deaths,
    "workspace": workspace.measure,
}
"""What is measured, in order."""
