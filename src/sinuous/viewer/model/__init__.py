"""What a page of `sinuous view` knows and does, without a browser."""
