"""Colours, lengths and type sizes, the same in vector drawings and in those painted by PyVista.

Colours of one kind differ in lightness, for grey print, and for colour-blind readers: tests/pictures/test_colours.py.
"""

from typing import Literal, TypeAlias

from .joint_state import JointState

Colouring: TypeAlias = Literal["displacement", "course"]
"""Whether blocks are coloured by displacement or by course."""

Colour: TypeAlias = tuple[float, float, float]

AT_REST: Colour = (0.955, 0.945, 0.925)
FASTEST: Colour = (0.50, 0.66, 0.84)
"""Colours of a block at rest and of the block that moves most."""

COURSES: tuple[Colour, Colour] = ((0.93, 0.90, 0.85), (0.80, 0.86, 0.93))
"""Colours of alternate courses."""

HELD: Colour = (0.72, 0.72, 0.72)
EDGE: Colour = (0.52, 0.52, 0.52)
OUTLINE: Colour = (0.45, 0.45, 0.45)

STATE_COLOURS: dict[JointState, str] = {
    JointState.SLIDE: "#005a43",
    JointState.OPEN: "#d55e00",
    JointState.DEBONDED: "#000000",
}
CRUSHED = "#aa00e6"
"""Colour of the crosses at crushed joint ends; joints that crush have no line colour."""

STATE_NAMES = {
    JointState.SLIDE: "slides",
    JointState.OPEN: "opens",
    JointState.DEBONDED: "debonded",
    JointState.CRUSHED: "crushes",
}

DARK = "0.25"
"""Colour of annotations, live loads and notes."""

DEAD, MOTION = "#0064a8", "#8531fa"
"""Colours of dead loads, whose arrows have hollow heads, and of prescribed displacements."""

BEAM: Colour = (0.55, 0.56, 0.58)
BLOCK_COLOURS: tuple[Colour, ...] = (
    AT_REST,
    (0.812, 0.616, 0.596),
    (0.804, 0.831, 0.525),
    (0.447, 0.627, 0.714),
    (0.929, 0.839, 0.690),
    (0.843, 0.725, 0.886),
    (0.859, 0.918, 0.816),
)
"""Colours of the beam, and of blocks by material."""

JOINT_COLOURS = ("0.35", "#bb932e", "#6f2008", "#67c7e5", "#358648", "#3f0340")
"""Colours of joints by material."""

DARKER, LIGHTER = 0.6, 0.6
"""Brightness of the colours of further blocks, and strength of those of further joints, if colours do not suffice."""

CHART_COLOURS = ("#2f3568", "#64baab", "#bf8111", "#943223", "#9b4db5")
"""Colours of the series of charts."""

UNIT = 8.0
"""Unit of length for the size of arrows and supports [pt]."""

TYPE, SMALL_TYPE = 7.5, 6.5
"""Type sizes [pt]: of titles and annotations, and of notes and keys."""

DRAWN, VISIBLE_GAP = 0.12, 0.004
"""Drawn displacement of the fastest corner, and smallest gap that is visible, both relative to `Scene.size`."""


TINTS = {JointState.SLIDE: 0.45, JointState.OPEN: 0.25, JointState.DEBONDED: 0.45}
"""Strength of the state colour that fills gaps; gaps of open joints are light, also in grey print."""


def tint(state: JointState) -> Colour:
    """A light shade of a state's colour."""
    colour = STATE_COLOURS[state]
    red, green, blue = (1 - TINTS[state] * (1 - int(colour[i : i + 2], 16) / 255) for i in (1, 3, 5))
    return red, green, blue


def block_colour(number: int) -> Colour:
    """Colour of blocks of a material; after the twelfth named one, colours are used again."""
    if not number:
        return BLOCK_COLOURS[0]
    named = BLOCK_COLOURS[1:]
    turn, k = divmod(number - 1, len(named))
    shade = DARKER if turn % 2 else 1.0
    red, green, blue = named[k]
    return shade * red, shade * green, shade * blue


def joint_colour(number: int) -> Colour:
    """Colour of a joint material; after the twelfth one, colours are used again."""
    from matplotlib.colors import to_rgb

    turn, k = divmod(number, len(JOINT_COLOURS))
    share = LIGHTER if turn % 2 else 1.0
    red, green, blue = (part + (1 - share) * (1 - part) for part in to_rgb(JOINT_COLOURS[k]))
    return red, green, blue
