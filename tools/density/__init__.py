"""Target densities other than |K|: samples that cover a surface."""
