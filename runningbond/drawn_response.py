"""A response that notebooks draw."""

from .pictures.captions import to_png, to_svg
from .pictures.response import response_figure
from .response import Response


class DrawnResponse(Response):
    """What `Wall.respond` returns: a response and its chart; none where the wall was not shaken."""

    def _repr_svg_(self) -> str | None:
        return to_svg(response_figure(self)).decode() if len(self.time) else None

    def _repr_png_(self) -> bytes | None:
        return to_png(response_figure(self)) if len(self.time) else None
