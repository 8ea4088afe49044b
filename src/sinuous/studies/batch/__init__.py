"""Any number of targets, through files: in chunks, on threads, processes or a cluster, whatever ends it meanwhile."""
