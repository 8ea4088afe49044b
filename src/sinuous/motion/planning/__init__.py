"""What a plan is made of: its question, its goals, and the sources of ways."""
