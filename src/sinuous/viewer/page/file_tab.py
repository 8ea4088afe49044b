"""The tab of files: save what is on the page, load another problem."""

from typing import TYPE_CHECKING, Any

from viser import GuiApi

from sinuous.viewer.page.fields import Fields

if TYPE_CHECKING:
    from sinuous.viewer.page.page import Page


def build(gui: GuiApi, page: "Page", fields: Fields) -> None:
    """Put the buttons into the panel."""
    save = gui.add_button("Save as YAML", hint="A problem file that says exactly what is on the page.")
    fields.press(save, lambda event: page.do(("save", event.client_id), lambda: page.save(event.client)))
    upload = gui.add_upload_button("Load a problem", color="gray", mime_type=".yaml,.yml,.json")

    @upload.on_upload
    async def _(event: Any) -> None:
        file = upload.value
        page.load(file.name, file.content)
