"""The experiments of the paper and one of our own: methods that solve the same problems in turns."""
