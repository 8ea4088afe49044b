"""Long runs: tasks for workers of any kind, and checkpoints that the same call goes on from."""
