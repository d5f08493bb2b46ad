"""Pages for browsers: a surface and the sphere of its normals; a click on one marks the other."""
