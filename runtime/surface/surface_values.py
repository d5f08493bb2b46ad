"""The values of a surface: its points and derivatives, and the functions that compute them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.checks import checked_array, parameter_arrays, text
from ..base.errors import InputError, shown
from ..base.evaluation import Needed, check_finite, evaluated
from ..base.georeference import Georeference
from ..base.kept import Immutable
from ..base.later import Later
from ..base.scales import scale_to_one
from ..domain.domain import Assumed, Boundary, Domain, checked_boundary, checked_domain, domain_text
from ..domain.trim import Trim
from ..spline.spline import short_label
from ..tape.kernels.points import Tape
from .derivatives import NAMES, Differences, Differentiable, Evaluation, Function, jet_function
from .traced import traced_tape


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceValues(Immutable):
    """The attributes of `Surface`, and their evaluation."""

    name: str
    function: Evaluation
    domain: Domain
    boundary: Boundary
    grid: NDArray[np.float64] | None = None
    derivative_function: Evaluation | None = None
    trim: Trim | None = None
    assumed_open: Assumed = (False, False)
    georeference: Georeference | None = None

    _bounds_of = Later("gaussmap.tools.support_points", "bounds_of")

    def __post_init__(self) -> None:
        text(self.name, "name")
        functions = {"function": self.function, "derivatives": self.derivative_function}
        for name, value in functions.items():
            if not callable(value) and (value is not None or name == "function"):
                raise InputError(
                    f"the {name} of a surface must be callable as f(u, v), and "
                    f"{type(value).__name__} is not."
                )
        for name, kind in (("trim", Trim), ("georeference", Georeference)):
            value = getattr(self, name)
            if value is not None and not isinstance(value, kind):
                raise InputError(f"{name} must be a {kind.__name__} or None, not {shown(value)}.")
        if self.grid is not None:
            checked_array("grid", self.grid, ("m", "n", 3), np.float64)
        object.__setattr__(self, "domain", checked_domain(self.domain))
        object.__setattr__(self, "boundary", checked_boundary(self.boundary)[0])

    def __repr__(self) -> str:
        grid = "" if self.grid is None else "{} × {} points, ".format(*self.grid.shape)
        trim = "" if self.trim is None else ", trimmed"
        where = domain_text(self.domain, self.boundary)
        return f"Surface({short_label(self.name)}: {grid}{where}{trim})"

    def evaluate(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """Return the points x(u, v).

        Parameters
        ----------
        u, v : array_like
            Parameters that broadcast together.

        Returns
        -------
        (..., 3) float64 array
            The points; outside of the trim, the callable may return NaN.

        Raises
        ------
        SurfaceError
            If the callable raises, returns another shape than (..., 3), anything but real numbers,
            or NaN or infinity inside of the trim; the message gives the parameters.
        InputError
            If the parameters are not real numbers, or lie outside the domain of a NURBS or of a
            surface that was given by points.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.surfaces.sphere().evaluate([0.0, 1.0], 0.0).shape
        (2, 3)

        """
        u_array, v_array = parameter_arrays(u, v)
        parameters = {"u": u_array, "v": v_array}
        return evaluated(self.function, parameters, 3, f"surface {self.name!r}", self._needed)

    @property
    def _needed(self) -> Needed | None:
        """The predicate of the parameters where values must be finite; None if everywhere."""
        return None if self.trim is None else self.trim.contains

    def derivatives(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """Return the points and their first and second derivatives.

        Derivatives are exact for the catalogue, for SymPy expressions and for NURBS, and given by
        the user for a callable with `derivatives`. Otherwise they are numerical: differences of
        nine points inside the domain, with steps of about 1/400 of the domain.

        Parameters
        ----------
        u, v : array_like
            Parameters that broadcast together.

        Returns
        -------
        (..., 6, 3) float64 array
            The vectors x, x_u, x_v, x_uu, x_uv and x_vv.

        Raises
        ------
        SurfaceError
            In the cases of `evaluate`; also if a derivative is not finite, or if given derivatives
            differ from numerical ones. The message gives the parameters.
        InputError
            If the parameters are not real numbers, or the surface was given by points.

        Notes
        -----
        The error of numerical derivatives, relative to the size and the domain of the surface, is
        1e-12 (first) and 1e-9 (second) if the shortest wavelength is at least a third of the
        domain, and 1e-10 and 1e-7 if up to 100 waves fit into the domain: if differences of seven
        points disagree with differences of nine, steps are divided by 4, up to five times. With a
        callable in single precision, first derivatives have four digits, and second ones none.

        Examples
        --------
        >>> import gaussmap as gm
        >>> x, x_u, x_v, x_uu, x_uv, x_vv = gm.surfaces.torus(minor=0.5).derivatives(0.0, 0.0)
        >>> x, x_u, x_vv
        (array([1.5, 0. , 0. ]), array([-0. ,  1.5,  0. ]), array([-0.5, -0. , -0. ]))

        """
        arrays = parameter_arrays(u, v)
        if self.grid is not None:
            raise InputError(
                f"{self.name!r} was given by points and has no derivatives; gm.fit makes a spline "
                "of it, which has normals and curvatures."
            )
        jets = self.jets(*(x.flatten() for x in arrays)).reshape(*arrays[0].shape, len(NAMES), 3)
        for row, name in enumerate(NAMES):
            parameters = dict(zip("uv", arrays, strict=True))
            label = f"{name} of surface {self.name!r}"
            check_finite(jets[..., row, :], parameters, label, self._needed)
        return jets

    def normals(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """Return the unit normals, along x_u × x_v, from `derivatives`.

        Parameters
        ----------
        u, v : array_like
            Parameters that broadcast together.

        Returns
        -------
        (..., 3) float64 array
            The normals; NaN at singular points, where x_u × x_v vanishes, such as poles.

        Raises
        ------
        SurfaceError, InputError
            As `derivatives`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.surfaces.torus().normals(0.0, [0.0, 0.5]).round(3) + 0.0
        array([[1.   , 0.   , 0.   ],
               [0.878, 0.   , 0.479]])

        """
        from ..spline.kernels.jets import evaluate_jets

        jets = self.derivatives(u, v)
        rows = jets.reshape(-1, len(NAMES), 3)
        (u0, u1), (v0, v1) = self.domain
        steps = np.array([u1 - u0, v1 - v0])
        size = scale_to_one(float(np.abs(rows[:, 1:3] * steps[:, None]).max(initial=0.0)))
        normals, gaussian, mean = np.empty((len(rows), 3)), np.empty(len(rows)), np.empty(len(rows))
        evaluate_jets(rows, np.array([size, *steps]), normals, gaussian, mean)
        normals[~normals.any(axis=1)] = np.nan
        return normals.reshape(*jets.shape[:-2], 3)

    def jets(self, u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the array of `derivatives`, faster: for flat arrays, without checks of values.

        Several threads may call this; a user's callable is called by one thread at a time.

        Parameters
        ----------
        u, v : (k,) float64 array
            Parameters.

        Returns
        -------
        (k, 6, 3) float64 array
            The vectors x, x_u, x_v, x_uu, x_uv and x_vv; NaN where they do not exist.

        Raises
        ------
        SurfaceError
            If a user's callable raises, or returns another shape or anything but real numbers, or
            if given derivatives differ from numerical ones.
        InputError
            For anything but two arrays of one shape (k,).

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> gm.surfaces.torus().jets(np.zeros(5), np.ones(5)).shape
        (5, 6, 3)

        """
        u_array = checked_array("u", u, ("k",), np.float64)
        v_array = checked_array("v", v, u_array.shape, np.float64)
        return self.unchecked_jets(u_array, v_array)

    @property
    def differences(self) -> Differences | None:
        """The finite differences that compute `derivatives`; None if formulas or the user do.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.surfaces.torus().differences is None
        True

        """
        owner = getattr(self.unchecked_jets, "__self__", None)
        if isinstance(owner, Differentiable):
            return owner.differences(self.boundary)
        return owner if isinstance(owner, Differences) else None

    @cached_property
    def tape(self) -> Tape | None:
        """The tape of operations that compute the surface, which gives bounds of its derivatives.

        It is known for the catalogue, for SymPy expressions and callables made of smooth elementary
        functions (of NumPy), for NURBS unless their degrees or nets are large, and for affine
        images of such surfaces; otherwise it is None. A callable is called with arrays of objects,
        and with numbers to compare the values.

        Examples
        --------
        >>> import gaussmap as gm
        >>> def f(u, v):
        ...     return np.stack([u, v, np.floor(u)], axis=-1)
        >>> gm.surfaces.torus().tape is None
        False

        """
        if self.grid is not None:
            return None
        if isinstance(self.function, Differentiable):
            return self.function.tape()
        return traced_tape(self.function, self.domain)

    @cached_property
    def unchecked_jets(self) -> Function:
        """The function that `jets` calls after its checks of u and v.

        It takes u and v as contiguous float64 arrays (k,), and returns an array (k, 6, 3). It saves
        time in many calls with few points each.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> gm.surfaces.torus().unchecked_jets(np.zeros(5), np.ones(5)).shape
        (5, 6, 3)

        """
        return jet_function(
            self.function, self.derivative_function, self.domain, self.boundary, self.name
        )
