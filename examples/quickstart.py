"""The front door in Python: a robot, a scene, a target; then a path; then a control loop. Lengths are in mm."""

import numpy as np

import sinuous as sn

# Five segments that hang down, each 45 to 70 mm long, and a ball in the way.
robot = sn.Robot.uniform(5, length=(45, 70), max_bend=2.4, radius=4, base=sn.pose(direction=(0, 0, -1)))
scene = sn.Scene([sn.Sphere((0, 80, -120), radius=25, name="ball")])

# One target: a place, and the direction to arrive in.
target = sn.Target((-60, 150, -230), direction=(-0.7071, 0, -0.7071))
solution = sn.solve(robot, target, scene)
print(solution)

# The answer can be checked by code that shares nothing with the solver.
print(solution.verify())

# What cannot be done is said, and why.
print(sn.solve(robot, sn.Target((0, 0, -400)), scene))

# A path: a circle below the ball, every point solved from the last.
angles = np.linspace(0.0, 2.0 * np.pi, 100)
circle = [sn.Target((80 * np.cos(a), 80 * np.sin(a), -250)) for a in angles]
print(sn.track(robot, circle, scene, start=solution))

# A control loop: prepared once, then microseconds a target.
solver = sn.Solver(robot, scene)
for waypoint in circle:
    solution = solver.solve(waypoint, initial=solution).raise_for_status()
print(f"{1e6 * solution.seconds:.0f} us for the last one")
