"""What solves: this library, timed and judged, its kernel in a loop, and what everybody else has at hand."""
