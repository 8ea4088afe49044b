"""The model of a page and the threads that work for it, without a browser."""

import logging
import threading
import time as clock
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable
from functools import partial
from typing import Any, Literal, TypeVar

from sinuous.answer.explanation import Explanation
from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.model.poses import pose
from sinuous.model.robot import Robot
from sinuous.motion.job import Job
from sinuous.motion.motion import Motion
from sinuous.motion.plan import TIME
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene
from sinuous.solver.memory import Memory
from sinuous.solver.options import SolveOptions
from sinuous.solver.solver import Solver
from sinuous.view.display.style import Colouring
from sinuous.view.page.edits import is_quick
from sinuous.view.page.model import History, Moment, PageModel, PageQuestion, playing_speed, read_problem

PATIENCE_SECONDS = 0.15
"""Seconds that a question must stand before a whole budget is spent on it."""

DETAILS_SECONDS = 0.1
"""Seconds between two changes of texts and fields."""

TICK_SECONDS = 1.0 / 30.0
"""Seconds between two pictures of what is played."""

QUICK_SECONDS = 0.01
"""Budget, in seconds, of a solve while something is dragged."""

Found = TypeVar("Found")

Sliders = Literal["bends and lengths", "actuators"]
"""What the sliders of the shape move."""

Event = Callable[[], object]
"""What is to be done; it runs in the thread of the worker."""

IDLE_SECONDS = 0.08
"""Seconds without a new event after which a worker is idle."""


def _nothing() -> None:
    """Do nothing."""


class Worker:
    """A thread that handles events in the order in which they were posted.

    An event replaces one under the same key that has not begun; so of many moves of a target only the latest is
    handled.

    Parameters
    ----------
    name : str
    failed : callable
        Called with every exception of an event.
    after : callable, optional
        Called when all events that were in the queue are handled.
    idle : callable, optional
        Called once when no event came for a while after that.
    """

    def __init__(
        self, name: str, failed: Callable[[Exception], object], after: Event = _nothing, idle: Event = _nothing
    ) -> None:
        self._failed, self._after, self._idle = failed, after, idle
        self._queue: dict[Hashable, Event] = {}
        self._condition = threading.Condition()
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name=f"sinuous-{name}", daemon=True)
        self._thread.start()

    def post(self, key: Hashable, event: Event) -> None:
        """Put an event at the end of the queue; returns at once."""
        with self._condition:
            self._queue.pop(key, None)
            self._queue[key] = event
            self._condition.notify()

    def stop(self) -> None:
        """End after the event that is handled now; wait for that."""
        with self._condition:
            self._stopped = True
            self._condition.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _run(self) -> None:
        busy = False
        while True:
            with self._condition:
                if not self._queue and not self._stopped:
                    self._condition.wait(IDLE_SECONDS if busy else None)
                if self._stopped:
                    return
                events, self._queue = list(self._queue.values()), {}
            if events:
                for event in events:
                    self._try(event)
                self._try(self._after)
            elif busy:
                self._try(self._idle)
            busy = bool(events)

    def _try(self, event: Event) -> None:
        try:
            event()
        except Exception as error:
            self._failed(error)


def memory_for(memory: Memory | None, robot: Robot) -> Memory | None:
    """Return a memory as long as it is of this robot: people change robots."""
    return memory if memory is not None and memory._serves(robot) else None


class Solvers:
    """Answers questions, one after the other, in one thread.

    Parameters
    ----------
    routes : bool
        Whether to search for routes where the first starts fail.
    memory : Memory, optional
        Shapes to begin from, as long as the robot is theirs; what is solved is added.
    """

    def __init__(self, routes: bool, memory: Memory | None = None) -> None:
        self._routes, self._memory = routes, memory
        self._known: tuple[Any, ...] | None = None
        self._solver: Solver | None = None

    def solver(self, question: PageQuestion) -> Solver:
        """Return a solver for what is asked.

        Raises
        ------
        InputError
            When the method does not handle the robot, or what is preferred.
        """
        job, own, snapshot = question.job, question.settings, question.scene
        place = len(snapshot) if own.method == "newton" else snapshot  # others sample the scene once
        known = (job.robot, job.tolerance, job.prefer, own.method, own.seed, own.time, place)
        if self._solver is None or known != self._known:
            options = SolveOptions(
                tolerance=job.tolerance,
                method=own.method,
                prefer=job.prefer,
                time=own.time,
                seed=own.seed,
                routes=self._routes,
                memory=memory_for(self._memory, job.robot),
            )
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", SuspiciousInput)  # the notes of the page say it
                self._solver = Solver._for_one_query(job.robot, Scene.of(snapshot), **vars(options))
            self._known = known
        self._solver.scene.become(snapshot)
        return self._solver

    def solve(self, question: PageQuestion, time: float | None = None) -> Solution:
        """Meet the targets from the shape on the page; `time` in seconds, by default that of the question."""
        return self.solver(question).solve(question.targets, question.initial, time=time)


class Session(ABC):
    """The model of a page, which one worker thread owns, and other workers for what takes long.

    Everything that people do is an event in the queue of the owner. After each batch of events it solves for some
    milliseconds and draws. Whole budgets, second methods, motions and files are left to the other workers; they post
    their answers to the owner, which drops an answer when the question has changed meanwhile.

    Parameters
    ----------
    job : Job
    answer : Solution, Motion or None
        What was found before, to begin with.
    memory : Memory, optional
        Shapes to begin from; what is solved is added.

    Attributes
    ----------
    model : PageModel
        To be read by any thread, and changed by the owner alone.
    playing : bool
    explaining : bool
        Whether somebody waits for what would help.
    dragged : bool
        Whether a gizmo was dragged: nobody has to be told then that it can be.
    axes : bool
        Whether axes with numbers are drawn.
    colouring : str
        What the colours of the body say.
    sliders : str
        What the sliders of the shape move.
    plotted : str
        What is drawn over the time of a motion.
    blend : float
        How far corners of a motion may be rounded.
    first_segment : int
        The first segment, 0 = first, that has sliders.
    refused : dict
        What the last event was refused for, in one line, under its key; empty where it was not.
    answered : callable
        Called with the number of every state of the model as soon as it has a shape.
    """

    def __init__(self, job: Job, answer: Solution | Motion | None = None, memory: Memory | None = None) -> None:
        self.model = PageModel(job)
        if isinstance(answer, Motion):
            self.model.show_motion(answer)
        elif answer is not None:
            self.model.q = answer.configuration
        self.playing = self.explaining = self.dragged = False
        self.axes = True
        self.colouring: Colouring = "segment"
        self.sliders: Sliders = "bends and lengths"
        self.plotted = "bends"
        self.blend = 0.0
        self.first_segment = 0
        self._history = History()
        self.answered: Callable[[int], object] = lambda number: None
        self.refused: dict[Hashable, str] = {}
        self._asked, self._busy, self._refreshed = -1, False, 0.0
        self._stopping = threading.Event()
        self._memory = memory
        self._quick = Solvers(routes=False, memory=memory)
        self._thorough, self._second = Solvers(routes=True, memory=memory), Solvers(routes=True)
        self._solving = Worker("solving", self._failed)
        self._solving_beside = Worker("solving-beside", self._failed)
        self._background = Worker("background", self._failed)
        self._player = Worker("player", self._failed)
        self._owner = Worker("owner", self._failed, self._settle, self._rest_a_while)

    @abstractmethod
    def _build(self) -> None:
        """Make everything that is shown anew, for another problem."""

    @abstractmethod
    def _draw(self) -> None:
        """Show the shape as it is now."""

    @abstractmethod
    def _update_hiding(self) -> None:
        """Look again at what hides the shape, which takes longer than to draw it."""

    @abstractmethod
    def _keep_in_view(self) -> None:
        """Let targets that went out of view be seen."""

    @abstractmethod
    def _refresh(self, busy: bool) -> None:
        """Show texts and fields as they are now; `busy`: a solve goes on."""

    def do(self, key: Hashable, change: Callable[[], object]) -> None:
        """Post an event that changes the model, in place of one under the same key; returns at once."""

        def event() -> None:
            before, history, self.refused = self.model.moment, self._history, {}
            try:
                change()
            except InputError as error:
                self.refused = {key: str(error)}
                return
            if not before.decided_like(self.model.moment):
                history.note(key, before)

        self._owner.post(key, event)

    def undo(self) -> None:
        """Take the last step back, as many times as it is called."""
        self._owner.post(object(), lambda: self._come_back(self._history.undo))

    def redo(self) -> None:
        """Do again what was taken back last."""
        self._owner.post(object(), lambda: self._come_back(self._history.redo))

    def _come_back(self, step: Callable[[Moment], Moment]) -> None:
        self.playing = False
        now = self.model.moment
        moment = step(now)
        if moment is not now:
            self.model.come_back(moment)

    def turn_view(self) -> None:
        """Look again at what hides the shape: somebody sees it from elsewhere."""
        self._owner.post("turn", lambda: None)

    @property
    def unsolved(self) -> bool:
        """Whether nothing was solved, and no solve goes on."""
        answer = self.model.answer
        return answer is not None and not (answer.solved or self._busy or self.model.by_hand)

    def wait(self) -> None:
        """Wait until somebody stops the page, or an interrupt comes."""
        while not self._stopping.wait(0.2):  # an interrupt is not heard within a longer wait on some systems
            pass

    def stop(self) -> None:
        """Stop all workers."""
        self.playing = False
        self._stopping.set()
        for worker in (self._player, self._background, self._solving_beside, self._solving, self._owner):
            worker.stop()

    def _failed(self, error: Exception) -> None:
        """Show in one line what was refused."""
        if not isinstance(error, InputError):
            logging.getLogger("sinuous").error("the page failed", exc_info=error)
        text = str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
        self._owner.post("refused", lambda: setattr(self, "refused", {"": text}))

    # What the owner does after every batch of events

    def _settle(self) -> None:
        model = self.model
        if model.number != self._asked:
            self._asked, self._busy = model.number, False
            if model.targets and not model.by_hand:
                self._answer()
            self.answered(model.number)
        self._draw()
        if clock.monotonic() - self._refreshed > DETAILS_SECONDS:
            self._refresh_now()

    def _refresh_now(self) -> None:
        self._update_hiding()
        self._refresh(self._busy)
        self._refreshed = clock.monotonic()

    def _rest_a_while(self) -> None:
        self._refresh_now()
        self._keep_in_view()

    def _answer(self) -> None:
        """Answer within milliseconds, and have others go on where that is not enough."""
        model = self.model
        self._answer_quickly()
        if model.answer is None or not model.answer.solved:
            self._busy = True
            self._solving.post("solve", partial(self._solve, model.question()))
        second = model.question_beside()
        if second is not None:
            self._solving_beside.post("solve", partial(self._solve_beside, second))

    def _answer_quickly(self) -> None:
        """Solve for some milliseconds, by the method that needs no more; others may have to be compiled first."""
        question, own = self.model.question(), self.model.settings
        if question.targets and own.method == "newton":
            self.model.accept(question.number, self._quick.solve(question, min(QUICK_SECONDS, own.time)))

    def _stands(self, question: PageQuestion) -> bool:
        """Wait a moment; return whether the question is still asked."""
        return not self._stopping.wait(PATIENCE_SECONDS) and question.number == self.model.number

    def _solve(self, question: PageQuestion) -> None:
        """Spend the whole budget on a question that stands."""
        if not self._stands(question):
            return
        try:
            solution = self._thorough.solve(question)
        finally:
            self._owner.post("busy", partial(self._rest, question.number))
        self._owner.post("answer", lambda: self.model.accept(question.number, solution))

    def _rest(self, number: int) -> None:
        self._busy = self._busy and number != self.model.number

    def _solve_beside(self, question: PageQuestion) -> None:
        if self._stands(question):
            solution = self._second.solve(question)
            self._owner.post("beside", lambda: self.model.accept_beside(question.number, solution))

    # What people do

    def move_target(self, index: int, position: Floats, rotation: Floats) -> None:
        """Move a target to the position (3,) and rotation (3, 3) of its gizmo."""
        self.dragged = True
        self.do(("target", index), lambda: self.model.place_target(index, position, rotation))

    def move_obstacle(self, position: Floats, rotation: Floats, let_go: bool) -> None:
        """Move the chosen obstacle with its gizmo; one that has to be prepared anew moves when it is let go."""
        place, chosen = pose(position, rotation=rotation), self.model.chosen
        if chosen is not None and is_quick(chosen):
            self.do("carry", lambda: self.model.carry(place))
        elif chosen is not None and let_go:
            self._find(self._background, "carry", partial(self._prepared, place), partial(self.model.put, place))

    def _prepared(self, place: Floats) -> Obstacle:
        """Return the chosen obstacle as it is at its new place (4, 4), ready to be asked."""
        obstacle = self.model.carried(place)
        Scene([obstacle]).prepare()
        return obstacle

    def _find(self, worker: Worker, key: str, find: Callable[[], Found], show: Callable[[Found], object]) -> None:
        """Have a worker find something, and show it where the question is still the same then."""
        number = self.model.number

        def run() -> None:
            found = find()
            self.do(key, lambda: show(found) if number == self.model.number else None)

        worker.post(key, run)

    def choose_obstacle(self, index: int | None) -> None:
        """Choose an obstacle, or none."""
        self.do("grasp", lambda: self.model.grasp(index))

    def find_others(self, count: int) -> None:
        """Look for distinct solutions."""
        question = self.model.question()

        def find() -> list[Solution]:
            found = self._thorough.solver(question).solve_all(question.targets, count=count)
            if not found:
                raise InputError("solutions", "none was found", 0, "a target that can be met")
            return found

        self._find(self._solving, "others", find, self.model.offer)

    def explain(self) -> None:
        """Look for what would help where nothing was solved."""
        answer = self.model.answer
        if answer is None or not self.unsolved:
            raise InputError("answer", "still looking, or solved", None, "a question that was not solved")
        self.explaining = True

        def find() -> Explanation:
            try:
                return answer.explain()
            finally:
                self._owner.post("explained", lambda: setattr(self, "explaining", False))

        self._find(self._background, "explain", find, partial(setattr, self.model, "explanation"))

    def move(self) -> None:
        """Follow the path, or plan a motion to the target or goal, and play it."""
        job, own, begin = self.model.job, self.model.settings, self.model.begin

        def find() -> Motion:
            memory = memory_for(self._memory, job.robot)
            if job.is_path:
                return job.track(method=own.method, seed=own.seed, time=own.time, memory=memory)
            seconds = max(own.time, TIME)
            return job.plan(method=own.method, seed=own.seed, time=seconds, begin=begin, memory=memory)

        self._find(self._background, "move", find, self._show_motion)

    def retime(self, blend: float) -> None:
        """Pass the way of the motion as fast as rates and accelerations allow, with corners rounded so far."""
        motion, rates = self.model.motion, self.model.job.rates
        if motion is None:
            raise InputError("motion", "none was found yet", None, "a motion")
        self._find(self._background, "move", lambda: motion.timed(rates, blend).as_motion(), self._show_motion)

    def _show_motion(self, motion: Motion) -> None:
        self.model.show_motion(motion)
        self.play(True)

    def load(self, name: str, content: bytes) -> None:
        """Show another problem; one that is none changes nothing."""

        def read() -> None:
            job = read_problem(name, content, self.model.folder)
            self.do("load", partial(self.replace, job))

        self._background.post("load", read)

    def replace(self, job: Job) -> None:
        """Show another problem; an event of the owner."""
        self.playing = False
        self.model.load(job)
        self.first_segment, self.colouring, self.sliders = 0, "segment", "bends and lengths"
        self._history = History()
        self._build()

    # What moves

    def play(self, running: bool) -> None:
        """Play the motion, or the obstacles that move, from where it is, or hold it; at its end, from the beginning."""
        self.playing = running
        if running:
            self._owner.post("rewind", self._rewind)
            self._player.post("play", self._run)

    def _rewind(self) -> None:
        first, last = self.model.window
        if first < last <= self.model.time:
            self.model.play(first)

    def _run(self) -> None:
        """Move on with the time, until the end."""
        last = clock.monotonic()
        while self.playing and not self._stopping.wait(TICK_SECONDS):
            now = clock.monotonic()
            self._owner.post("tick", partial(self._tick, now - last))
            last = now
        self.playing = False

    def _tick(self, seconds: float) -> None:
        first, last = self.model.window
        if first == last:
            self.playing = False
        if not self.playing:
            return
        time = self.model.time + seconds * playing_speed(last - first)
        if time >= last:
            time, self.playing = last, False
        self.model.play(max(first, time))

    def go_to(self, share: float) -> None:
        """Show what moves after this share of its time; an event of the owner."""
        first, last = self.model.window
        if first < last:
            self.model.play(min(last, first + share * (last - first)))
