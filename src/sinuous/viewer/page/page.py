"""The page of `sinuous view`: the model, the threads that work for it, and what the browser shows."""

import logging
import threading
import time as clock
from collections.abc import Callable, Hashable
from functools import partial
from typing import Any

from viser import ClientHandle

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.motion.job import Job
from sinuous.motion.motion import Motion
from sinuous.motion.plan import TIME
from sinuous.poses import pose
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution
from sinuous.viewer.drawing.colours import Colouring
from sinuous.viewer.drawing.stage import close_server, light, open_server
from sinuous.viewer.model.edits import is_quick
from sinuous.viewer.model.judging import judge, nearest
from sinuous.viewer.model.model import Model
from sinuous.viewer.model.saving import loaded, saved
from sinuous.viewer.model.solvers import QUICK, Question, Solvers
from sinuous.viewer.pace import pace
from sinuous.viewer.page import panel, words
from sinuous.viewer.page.scenery import Scenery
from sinuous.viewer.workers import Worker

PATIENCE = 0.15
"""Seconds that a question must stand before a whole budget is spent on it."""

DETAILS = 0.1
"""Seconds between two changes of texts and fields."""

TICK = 1.0 / 30.0
"""Seconds between two pictures of what is played."""


class Page:
    """A page that any number of browsers look at.

    The model belongs to one thread, the desk: all that people do is posted there, and what was overtaken is never
    begun. After each batch of changes it solves for some milliseconds and draws. Whole budgets, second methods, paths
    and files are work for other threads, whose answers are dropped when the question has changed meanwhile.

    Parameters
    ----------
    job : Job
    host : str
    port : int
        0: any that is free.
    answer : Solution, Motion or None
        What was found before, to begin with.

    Attributes
    ----------
    model : Model
    answered : callable
        Called with the number of every state of the model as soon as it has a shape.
    """

    def __init__(
        self, job: Job, host: str = "127.0.0.1", port: int = 0, answer: Solution | Motion | None = None
    ) -> None:
        self.model = Model(job)
        if isinstance(answer, Motion):
            self.model.show_motion(answer)
        elif answer is not None:
            self.model.q = answer.q
        self.server = open_server(host, port)
        self.playing = False
        self.first_segment = 0
        self.answered: Callable[[int], object] = lambda number: None
        self._notice = ""
        self._asked = -1
        self._busy = False
        self._detailed = 0.0
        self._stopping = threading.Event()
        self._quick, self._thorough, self._second = Solvers(routes=False), Solvers(routes=True), Solvers(routes=True)
        self._build()
        self._patient = Worker("patient", self._failed)
        self._beside = Worker("beside", self._failed)
        self._errands = Worker("errands", self._failed)
        self._player = Worker("player", self._failed)
        self._desk = Worker("desk", self._failed, self._settle, self._detail)
        self.do("begin", lambda: None)

    def _build(self) -> None:
        """Make everything on the page anew, for a robot that is where it first gets to."""
        question = self.model.question()
        if question.targets and question.method == "newton":
            self.model.accept(question.number, self._quick.solve(question, min(QUICK, question.time)))
        self.server.gui.reset()
        self.server.scene.reset()
        light(self.server)
        self.scenery = Scenery(self.server, self.model, self._target_moved, self._obstacle_moved, self._clicked)
        self._panel = panel.Panel(self)

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self.server.get_port())

    def do(self, key: Hashable, change: Callable[[], object]) -> None:
        """Have the model changed, unless something newer is posted under the same key; returns at once."""

        def act() -> None:
            change()
            self._notice = ""

        self._desk.post(key, act)

    def wait(self) -> None:
        """Wait until somebody stops the page, or an interrupt comes."""
        while not self._stopping.wait(0.2):  # an interrupt is not heard within a longer wait on some systems
            pass

    def stop(self) -> None:
        """Close the page."""
        self.playing = False
        self._stopping.set()
        for worker in (self._player, self._errands, self._beside, self._patient, self._desk):
            worker.stop()
        close_server(self.server)

    # What the desk does after every batch of changes

    def _settle(self) -> None:
        model = self.model
        if model.number != self._asked:
            self._asked, self._busy = model.number, False
            if model.targets and not model.by_hand:
                self._answer()
            self.answered(model.number)
        self._draw()
        if clock.monotonic() - self._detailed > DETAILS:
            self._detail()

    def _answer(self) -> None:
        """Answer within milliseconds, and have others go on where that is not enough."""
        model = self.model
        question = model.question()
        if question.method == "newton":  # others may have to be compiled, or take long
            model.accept(question.number, self._quick.solve(question, min(QUICK, question.time)))
        if model.answer is None or not model.answer.solved:
            self._busy = True
            self._patient.post("solve", partial(self._think, model.question()))
        second = model.question_beside()
        if second is not None:
            self._beside.post("solve", partial(self._think_beside, second))

    def _think(self, question: Question) -> None:
        """Spend the whole budget on a question that stands."""
        if self._stopping.wait(PATIENCE) or question.number != self.model.number:
            return
        try:
            solution = self._thorough.solve(question)
        finally:
            self._desk.post("busy", partial(self._rest, question.number))
        self._desk.post("answer", lambda: self.model.accept(question.number, solution))

    def _rest(self, number: int) -> None:
        self._busy = self._busy and number != self.model.number

    def _think_beside(self, question: Question) -> None:
        if self._stopping.wait(PATIENCE) or question.number != self.model.number:
            return
        solution = self._second.solve(question)
        self._desk.post("beside", lambda: self.model.accept_beside(question.number, solution))

    def _draw(self) -> None:
        model = self.model
        self.near = nearest(model.robot, model.there, model.shown) if self._panel.shows_nearest else None
        self.scenery.show(self.near)

    def _detail(self) -> None:
        """Show texts and fields as they are now."""
        model = self.model
        judged = judge(model.robot, model.targets, model.q) if model.by_hand else None
        status = words.status_of(model, self.near, judged, self._busy)
        with self.server.atomic():
            self._panel.refresh(status, words.notice(self._notice))
        self._detailed = clock.monotonic()

    def _failed(self, error: Exception) -> None:
        """Say in one line what was refused."""
        if not isinstance(error, InputError):
            logging.getLogger("sinuous").error("the page failed", exc_info=error)
        text = str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"

        def tell() -> None:
            self._notice = text

        self._desk.post("notice", tell)

    # What people do

    def _target_moved(self, index: int) -> Callable[[Floats, Floats, bool], None]:
        def moved(position: Floats, rotation: Floats, let_go: bool) -> None:
            self.do(("target", index), lambda: self.model.place_target(index, position, rotation))

        return moved

    def _obstacle_moved(self, position: Floats, rotation: Floats, let_go: bool) -> None:
        place = pose(position, rotation=rotation)
        chosen = self.model.chosen
        if chosen is None:
            return
        if is_quick(chosen):
            self.do("carry", lambda: self.model.carry(place))
        elif let_go:
            self._errands.post("carry", partial(self._carry_slowly, place, self.model.number))

    def _carry_slowly(self, place: Floats, number: int) -> None:
        """Move what has to be prepared anew, like a mesh, while the page goes on."""
        obstacle = self.model.carried(place)
        Scene([obstacle]).prepare()
        self.do("carry", lambda: self.model.put(place, obstacle) if number == self.model.number else None)

    def _clicked(self, index: int) -> None:
        self.do("grasp", lambda: self.model.grasp(index))

    def colour(self, colouring: Colouring) -> None:
        """Let the colours of the body say something else."""

        def change() -> None:
            self.scenery.colouring = colouring

        self.do("colour", change)

    def show_segments(self, first: int) -> None:
        """Show the sliders of other segments."""

        def change() -> None:
            self.first_segment = first

        self.do("segments", change)

    def find_others(self, count: int) -> None:
        """Look for distinct solutions."""
        question = self.model.question()

        def find() -> None:
            found = self._thorough.solver(question).solve_all(question.targets, count=count)
            if not found:
                raise InputError("solutions", "none was found", 0, "a target that can be met")
            self.do("others", partial(self._show_others, question.number, found))

        self._patient.post("others", find)

    def _show_others(self, number: int, found: list[Any]) -> None:
        if number == self.model.number:
            self.model.ghosts = found
            self.model.choose(0)

    def forget_others(self) -> None:
        """Take other solutions from the page."""
        self.model.ghosts = []

    def move(self) -> None:
        """Follow the path, or plan a motion to the target or goal, and play it."""
        question = self.model.question()
        job, own, begin = question.job, self.model.settings, self.model.begin

        def run() -> None:
            if job.is_path:
                motion = job.track(method=own.method, seed=own.seed, time=own.time)
            else:
                motion = job.plan(method=own.method, seed=own.seed, time=max(own.time, TIME), begin=begin)

            def put() -> None:
                if self.model.number == question.number:
                    self.model.show_motion(motion)
                    self.play(True)

            self.do("motion", put)

        self._errands.post("move", run)

    def play(self, running: bool) -> None:
        """Play the motion, or the obstacles that move, from where it is, or hold it; at its end, from the beginning."""
        self.playing = running
        if running:
            self._desk.post("rewind", self._rewind)
            self._player.post("play", self._run)

    def _rewind(self) -> None:
        first, last = self.model.window
        if first < last <= self.model.time:
            self.model.play(first)

    def _run(self) -> None:
        """Move on with the time, until the end."""
        last = clock.monotonic()
        while self.playing and not self._stopping.wait(TICK):
            now = clock.monotonic()
            self._desk.post("tick", partial(self._tick, now - last))
            last = now
        self.playing = False

    def _tick(self, seconds: float) -> None:
        first, last = self.model.window
        if first == last:
            self.playing = False
        if not self.playing:
            return
        time = self.model.time + seconds * pace(last - first)
        if time >= last:
            time, self.playing = last, False
        self.model.play(max(first, time))

    def go_to(self, share: float) -> None:
        """Show what moves after this share of its time."""
        first, last = self.model.window
        if first < last:
            self.model.play(min(last, first + share * (last - first)))

    def save(self, client: ClientHandle | None) -> None:
        """Send the problem on the page to a browser, as a file."""
        text = saved(self.model)
        if client is not None:
            client.send_file_download("problem.yaml", text.encode(), save_immediately=True)

    def load(self, name: str, content: bytes) -> None:
        """Show another problem; one that is none changes nothing."""

        def read() -> None:
            job = loaded(name, content, self.model.folder)
            self.do("load", partial(self._replace, job))

        self._errands.post("load", read)

    def _replace(self, job: Job) -> None:
        self.playing = False
        self.model.load(job)
        self.first_segment = 0
        self._build()
