"""Pages that show samples and their normals, linked."""
