"""The page of `sinuous view`: what can be dragged, typed and pressed."""
