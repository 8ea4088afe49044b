"""Wild problems: whatever a robot can be, with hidden solutions, so that every claim can be held against one."""
