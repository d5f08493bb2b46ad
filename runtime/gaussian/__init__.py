"""What the Gauss map does: images of patches, and parabolic points, where it folds."""
