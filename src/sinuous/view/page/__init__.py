"""Pages in three dimensions: what `show` draws, and the page of `sinuous view`."""
