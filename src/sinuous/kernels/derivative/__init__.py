"""How an answer changes with what it depends on: rows at the answer, their right sides, and one system for both."""
