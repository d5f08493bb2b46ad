"""The methods of `Part` that modules above it define; `methods.py` loads them."""

class Methods:
    from ..pictures.plot import plot_part as plot
    from .measures import bounds_of as _bounds_of
    from .measures import volume_of as _volume_of
    from .results import coverage_of as _coverage_of
    from .results import deviation_of as _deviation_of
    from .results import weights_of as _weights_of
    from .sampling import sample_part as _sampled
