"""Follow the leader: the body moves along the curve that its tip has made."""
