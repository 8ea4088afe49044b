"""Experiments that measure this library against its goals and against others, every answer checked by other code.

`python -m benchmarks NAME` runs one, from a clone of the repository with `pip install -e ".[bench]"`. The rooms, from
the ground up; each imports from those before it only:

- `harness`: pieces, journal, lines, report, baseline
- `judges`: kinematics, distances and collisions by other code
- `problems`: random problems from seeds, and those of the literature
- `solvers`: ours, timed and judged; its kernel in a loop; SciPy and IPOPT
- `places`: intricate places with a hidden shape; `pictures`: how figures look
- `speed`, `clutter`, `paper`: the experiments
"""
