"""Methods of splines that later modules define; `spline_methods.pyi` has their signatures."""

from ..base.later import Later


class Methods:
    """Constructors of splines other than `fit`."""

    from_nets = Later("gaussmap.runtime.spline.nets")


class NetMethods:
    """Results derived from splines of nets."""

    mesh = Later("gaussmap.tools.meshes.of_nets")
