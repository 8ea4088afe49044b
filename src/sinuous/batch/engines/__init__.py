"""What solves chunks: threads, processes, any executor, Dask. One protocol for all."""
