"""What pictures and pages have in common: what is shown, its surfaces, its bounds, its colours and its captions."""
