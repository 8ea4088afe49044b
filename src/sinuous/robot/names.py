"""What segments and what drives them are called in messages and results."""


def tendon_name(segment: int, line: int) -> str:
    """Name of a tendon that ends at `segment`; both are counted from 1."""
    return f"s{segment}.t{line}"


def chamber_name(segment: int, line: int) -> str:
    """Name of a chamber of `segment`; both are counted from 1."""
    return f"s{segment}.c{line}"
