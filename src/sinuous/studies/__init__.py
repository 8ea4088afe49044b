"""What asks the solver many times: batches, maps of the workspace, sets of tasks, design, exploring, calibration."""
