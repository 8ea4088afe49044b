"""The chain laid along a route, and what a robot and its target ask of a route.

The doors are `query.route_query` and `fit.fit_route`.
"""
