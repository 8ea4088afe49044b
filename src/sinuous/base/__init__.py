"""Words of refusal, checks, and how values are written down: what every other room uses, and knows none of them."""
