"""How questions and answers are written down: problem files in YAML or JSON, paths in CSV, results as JSON lines."""
