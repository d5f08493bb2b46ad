"""Triangle meshes through samples."""
