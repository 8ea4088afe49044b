"""Tables of a body of arcs under load. `tables` owns those of all other kernels; these are met nowhere else.

A body has N arcs, numbered from the base. The state `x` (N, 4) of an arc is its bend `v` (2, rad), its torsion (rad)
and its length: an arc, then a roll about the tangent at its end. Forces are in the world, in any unit that stiffness
has.
"""

import math

BEND_X, BEND_Y, TORSION, LENGTH = range(4)
"""Columns of the state, and of whatever has one number for each of its coordinates."""

STATE_WIDTH = 4

RIGID = math.inf
"""Stiffness of what does not give."""

ARC_COUNT, BENDING, REST_BEND, PULLED, HEAVY, SECTION_TAIL = 0, 1, 4, 6, 7, 10
"""Columns of `sections` (n, 23), what a robot is made of whatever its drive `q` (n, 3) is: joints and links, then
segments. How many arcs; EI, GJ and EA, infinite for what does not give; bend at rest (2) of one whose bends are
`PULLED`, 1, by lines, while others have that of the drive; weight per length (3). Of joints and links 1, and the pose
in the frame of its end in which the next begins (12); of segments zeros."""

TAIL_WIDTH = 13

(BEND_STIFFNESS, TORSION_STIFFNESS, STRETCH_STIFFNESS, REST_X, REST_Y, REST_LENGTH, WEIGHT) = range(7)
"""Columns of `arcs` (N, 22). EI, GJ and EA divided by the length of the arc, infinite for what does not give; bend and
length without any load; weight (3, force in the world). Bends without load turn with half of the torsion. What follows
is the tail (`ARC_TAIL`), as of `sections`."""

ARC_TAIL = 9

ARC_WIDTH = ARC_TAIL + TAIL_WIDTH

LOAD_ARC, FORCE, MOMENT, LOAD_OFFSET = 0, 1, 4, 7
"""Columns of `loads` (k, 10). Number of the arc at whose end it acts; force (3) and moment (3) in the world, which stay
as they are while the body moves; where the force acts in the frame of that end (3)."""

LOAD_WIDTH = 10

FIRST_ARC, LAST_ARC, ARM, STRAIGHT, HELD, PUSHES, LINE_VALUE, COMPLIANCE, FIRST_SLOPE = 0, 1, 2, 4, 5, 6, 7, 8, 9
"""Columns of `lines` (t, 10): tendons and chambers. The first and the last arc that it runs through; where it runs in
the frames of the body (2); 1 where it runs straight from the end of one arc to that of the next, 0 where it follows
the arcs; 1 where its length is held, 0 where its tension is; 1 where it can push, too; that length or tension; by how
much one unit of tension stretches it; and its first row in `slopes`."""

LINE_WIDTH = 10

TWIST_COLUMNS, GRADIENT, HESSIAN, CENTER_COLUMNS, ARC_CENTER, RESIDUAL, INVERSE, FEEDBACK, PUSH, PIVOT = (
    0,
    24,
    28,
    44,
    53,
    56,
    60,
    76,
    100,
    112,
)
"""Columns of `stages` (N, 128), what is known of each arc. Four twists `(omega, v)` in world axes about the base: how
all beyond moves with its state; derivatives of its own energy, lines and weight (4; 4 x 4); how its center of gravity
moves with bends and length (3 vectors in the world), and where that is from the base; what is left of its equilibrium
(4); and of the factors of the sweeps the inverse pivot (4 x 4), the answer to a twist of where it begins (4 x 6), what
its state adds to the moment of the loads about the base (4 vectors), and the pivot (4 x 4)."""

STAGE_WIDTH = 128

ARC_WORK = 1000
"""Work units that an equilibrium, or a bound on how far it may leave a way, costs for every arc."""
