"""The experiments of `bench speed`: each file is one, each `measure(plan)` yields its lines as it gets them."""
