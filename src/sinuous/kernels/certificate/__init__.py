"""The body on its way from one configuration to another."""
