"""From initial configurations to a judged answer."""
