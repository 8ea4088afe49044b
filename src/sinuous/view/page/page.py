"""The page of `sinuous view`: what browsers show of a session, and what people do in them."""

from viser import ClientHandle

from sinuous.answer.solution import Solution
from sinuous.motion.job import Job
from sinuous.motion.motion import Motion
from sinuous.solver.memory import Memory
from sinuous.view.page.panel import Action, Panel
from sinuous.view.page.scenery import Scenery
from sinuous.view.page.server import close_server, light, open_server
from sinuous.view.page.session import Session
from sinuous.view.page.status import judge, nearest, notice, status_of


class Page(Session):
    """A page that any number of browsers look at.

    Parameters
    ----------
    job : Job
    host : str
    port : int
        0: any that is free.
    answer : Solution, Motion or None
        What was found before, to begin with.
    memory : Memory, optional
        Shapes to begin from; what is solved is added.
    """

    def __init__(
        self,
        job: Job,
        host: str = "127.0.0.1",
        port: int = 0,
        answer: Solution | Motion | None = None,
        memory: Memory | None = None,
    ) -> None:
        super().__init__(job, answer, memory)
        self.server = open_server(host, port)
        self.server.on_client_connect(self._watch)
        self._build()
        self.do("begin", lambda: None)

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self.server.get_port())

    def stop(self) -> None:
        """Close the page."""
        super().stop()
        close_server(self.server)

    def _actions(self) -> tuple[Action, ...]:
        return (
            Action("Undo", "Z", "cmd/ctrl", lambda _: self.undo()),
            Action("Redo", "Z", "cmd/ctrl+shift", lambda _: self.redo()),
            Action("Fit view", "F", None, lambda client: self.do("fit", lambda: self.scenery.fit(client))),
        )

    def _build(self) -> None:
        self._answer_quickly()  # so that the camera looks at where the robot first gets to
        self.server.gui.reset()
        self.server.scene.reset()
        light(self.server)
        self.scenery = Scenery(self.server, self)
        self._panel = Panel(self.server.gui, self, self._actions())

    def _draw(self) -> None:
        model = self.model
        self.near = nearest(model.robot, model.there, model.shown)
        self.scenery.show(self.near)

    def _watch(self, client: ClientHandle) -> None:
        client.camera.on_update(lambda _: self.look())

    def _look(self) -> None:
        self.scenery.look()
        self.scenery.show(self.near)

    def _refresh(self, busy: bool, refused: str) -> None:
        model = self.model
        judged = judge(model.robot, model.targets, model.q) if model.by_hand else None
        with self.server.atomic():
            self._panel.refresh(status_of(model, self.near, judged, busy), notice(refused))
