"""What would help: changes of a problem that are tried, solved and proved before they are told."""
