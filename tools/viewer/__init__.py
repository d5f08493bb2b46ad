"""Pages for browsers with samples and their normals: a click on one marks the other."""
