"""Solutions that pass the obstacles on different sides: which curves are alike, and where else a route may lead."""
