"""Pictures, and pages in the browser, of robots, scenes and answers."""
