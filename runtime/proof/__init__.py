"""Every point of a surface that has a given normal, with a proof."""
