"""From one configuration to the next."""
