"""Experiments that measure this library against its goals and against others, every answer checked by other code.

`python -m benchmarks NAME` runs one, from a clone of the repository with `pip install -e ".[bench]"`. From the ground
up; each imports from those before it only:

- `harness`: lines, machine, parts, processes, journal, report
- `judges`: kinematics, limits, distances and collisions by other code
- `problems`: random problems from seeds, and those of the literature
- `places`: intricate places with a hidden shape, made of `places.parts` and `places.solids`
- `wild`: worlds of anything that can be built, from which others draw, too
- `speed`, `clutter`, `ways`, `motion`, `methods`, `many`, ...: the experiments, each named in `__main__.KNOWN`
- `mbm`: the same of problems that are given; `corpus`, `rooms`, `trace`: commands of their own
"""
