"""Ends of the robot in tubes: what a tube holds is laid along its axis, and what is left is solved by itself."""
