"""Routes of a ball from one sharp edge to the next: a visibility graph, quick where walls are few and large.

It proves nothing: what it does not find may be there. The door is `find.find_by_edges`.
"""
