"""Settings that all tests share."""

import gc
import multiprocessing
import os
import signal
import sys
from collections import Counter
from collections.abc import Generator, Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Matrices are tiny here: threads of a linear algebra library only wait for each other, on a busy machine a thousand
# times as long as the work takes. Read when NumPy is first imported, which is later.
for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

# A shell starts background jobs with interrupts ignored, and what they start inherits that: tests send interrupts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Two processes collect more than 400 files, and tests start some hundred more: what one made of the sources the others
# read, whatever is usual on this machine (git ignores it). Not to read it costs twenty seconds for collecting alone.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# Pictures that tests draw are shown nowhere.
os.environ.setdefault("MPLBACKEND", "agg")

# Kernels run compiled, whatever happens to be compiled already, unless the command says how.
os.environ.setdefault("SINUOUS_KERNELS", "compiled")

# The first example of a law may compile a kernel, so that time says nothing; the same examples every time.
settings.register_profile(
    "sinuous",
    max_examples=30,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("sinuous")

HERE = Path(__file__).parent

# Processes of a pool are forked from one that has loaded what they need: to begin each anew takes a second. Where there
# is no such server (Windows), and in what tests start as a program, they are begun as they are for users.
if "forkserver" in multiprocessing.get_all_start_methods():
    multiprocessing.set_forkserver_preload(["tests.loaded"])
    _context = multiprocessing.get_context
    multiprocessing.get_context = lambda method=None: _context("forkserver" if method == "spawn" else method)  # type: ignore[assignment]


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Share the whole suite among the processors, unless the command says how; single files run in this process.

    A file stays together: its tests call the same kernels, and what one process compiles the others find on disk.
    """
    mine = config.pluginmanager.hasplugin("xdist") and not hasattr(config, "workerinput")
    if mine and config.option.numprocesses is None and [Path(arg).resolve() for arg in config.args] == [HERE]:
        config.option.numprocesses = "auto"
        config.option.dist = "loadfile"
        config.option.loadscopereorder = False


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Look for no garbage while tests are collected, nor later among what was: all of it stays to the end.

    And look seldom afterwards: what tests import and compile stays, too, and is more than they leave behind.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()
        gc.set_threshold(20_000, 20, 50)


@pytest.fixture(autouse=True)
def inner_kernels_are_interpreted(request: pytest.FixtureRequest) -> Iterator[None]:
    """Let tests call inner kernels, which have no wrappers, as Python: nothing is compiled for tests alone."""
    import numpy as np

    if "sinuous.kernels.compile" in sys.modules:
        sys.modules["sinuous.kernels.compile"].interpret_all()
    silent = request.path.relative_to(HERE).parts[0] in {"kernels", "methods"}  # as machine code is
    with np.errstate(all="ignore") if silent else nullcontext():
        yield


@pytest.fixture(autouse=True)
def proofs_of_steps_have_time() -> None:
    """Let proofs end by what they find: of 0.05 s by the clock, a busy machine may give them nothing."""
    if "sinuous.solver.certificates.steps" in sys.modules:
        steps = sys.modules["sinuous.solver.certificates.steps"]
        for function in (steps.Prover.prove, steps.prove_steps):
            function.__defaults__ = tuple(
                PROOF_SECONDS if each == steps.SECONDS else each for each in function.__defaults__
            )


@pytest.fixture(autouse=True)
def entries_have_one_form() -> Iterator[None]:
    """Refuse a second form of an entry, for numbers or arrays of another kind: who asks for it waits for a compiler."""
    before = forms_of_entries()
    yield
    new = forms_of_entries() - before
    assert not any(new[name] and count > 1 for name, count in forms_of_entries().items()), new


def forms_of_entries() -> Counter[str]:
    """How many forms of each entry of the package there are in this process."""
    if "sinuous.kernels.compile.tiers" not in sys.modules:
        return Counter()
    tiers = sys.modules["sinuous.kernels.compile.tiers"]
    own = [each for each in tiers.ENTRIES.values() if each.__module__.startswith("sinuous.")]
    return Counter(tiers.name_of(each, form) for each in own for form in each.signatures)


PROOF_SECONDS = 2.0
"""Of a step, by the clock: forty times what users wait for it."""


@pytest.fixture(autouse=True)
def no_figures_stay() -> Iterator[None]:
    """Close what a test drew with pyplot, which keeps it."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


FIRST = (
    "solver/routing/test_routes.py",  # our own method and routes, for one process
    "methods/opti_path/test_options.py",  # methods that share little with it, for the other
    "methods/test_slinki.py",
    "methods/fabrik/test_reaching.py",
    "methods/test_monte_carlo.py",
    "methods/fabrik/test_reaching_avoiding.py",
    "benchmarks/test_experiments.py",  # motions and control loops, while the first still compiles routes
    "benchmarks/test_wild.py",  # loads
    "solver/test_options.py",  # preferences, and routes again
    "solver/test_live.py",
    "view/page/test_page.py",  # waits for a browser
    "benchmarks/places/test_places.py",  # takes long
    "studies/batch/test_deaths.py",
    "test_cookbook.py",
    "answer/derivatives/test_derivative.py",
)
"""Files that come first: they compile most, and two processes that began alike would compile the same; then those that
take longest, so that none of these is left for one process at the end."""


WORKER = os.environ.get("PYTEST_XDIST_WORKER", "")


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Iterator[pytest.CollectReport]:
    """Let every second process collect from the other end: each rewrites the assertions of half of the files."""
    report: pytest.CollectReport = yield  # type: ignore[assignment, misc]
    if isinstance(collector, pytest.Directory) and WORKER.endswith(("1", "3", "5", "7", "9")):
        report.result.reverse()
    return report  # type: ignore[return-value]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files that compile most, and those that take longest, in front."""
    places = {(HERE / name).resolve(strict=True): place for place, name in enumerate(FIRST)}
    items.sort(key=lambda item: (places.get(item.path, len(FIRST)), item.path.parts if WORKER else ()))
