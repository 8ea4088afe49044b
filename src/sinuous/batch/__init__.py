"""Any number of targets, through files: in chunks, on threads, processes or a cluster, and on after whatever ended it."""
