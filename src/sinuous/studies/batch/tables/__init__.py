"""Tables of targets and of results: CSV, NPZ, Parquet, and arrays in memory."""
