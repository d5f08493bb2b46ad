"""The methods of `Part` defined in modules that import `Part`; `part_methods.py` loads them."""

class Methods:
    from ..pictures.plot import plot_part as plot
    from ..support_points import bounds_of as _bounds_of
    from .face_columns import face_columns as _face_columns
    from .from_surfaces import part_of_surfaces as _made_of
    from .measures import gap_of as _gap_of
    from .measures import volume_of as _volume_of
    from .part_sampling import sample_part as _sampled
    from .part_sampling import samples_at as _samples_at
    from .reached import reached as _space
    from .reached import with_edges as _boundaries
    from .selection import select as select
