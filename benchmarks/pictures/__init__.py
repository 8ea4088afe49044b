"""How pictures of experiments look."""
