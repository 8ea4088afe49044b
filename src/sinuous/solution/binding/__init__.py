"""What holds a configuration back: limits and contacts, one by one, and those that carry the pull of the targets."""
