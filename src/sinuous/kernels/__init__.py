"""Compiled arithmetic: arrays and tuples in, arrays and tuples out; no classes, no files, no printing.

Arrays are float64 and C-contiguous, unless it is said otherwise. Frames are those of the world, lengths are in the
length unit of the user, and angles in rad. These names mean the same everywhere, and docstrings do not explain them
again:

- `q` (n, 3): a configuration, of each segment the bend (x, y; rad) and the length;
- `limits` (n, 35): rows of segments: limits, scales, radii, links; `actuation` (p, 7): rows of limits of actuators, see
  `tables`;
- `frames` (n + 1, 12): of the base and of the end of each segment the rotation (9, row after row) and the origin (3);
- `base` (1, 12), `tool` (1, 12): such a frame of the base in the world, and of the tool in the end of the last segment;
- `robot` (w,), `scene` (w,), `settings` (w,), `targets` (t, 15): groups, laid out as `tables` says;
- `table` (m, 33), `store` (w,): rows of obstacles, and the numbers that these point to, see `tables`;
- `root` (n, 9): of each segment the root of the metric (3 x 3) in which its motion is measured;
- `clock` (CLOCK_SIZE,): what counts time and work, see `clock`;
- `buffer` (w,), `workspace` (w,): memory that arrays are laid out in, as large as the function says that is named.

In `statics`, of a body of N arcs: `x` (N, 4), `arcs` (N, 22), `loads` (k, 10), `lines` (t, 10), `sections` (n, 23) and
`stages` (N, 128) as its `layout` says, and `tensions` (t,) of lines (force).
"""
