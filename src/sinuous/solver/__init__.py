"""From a problem to a solution: start sources, budgets, distinct solutions."""
