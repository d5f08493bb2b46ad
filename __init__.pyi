"""The public names and where they are defined; `__init__.py` loads them from here."""

from . import symbolic as symbolic
from .runtime import curves as curves
from .runtime import directions as directions
from .runtime import errors as errors
from .runtime import gauss_map as gauss_map
from .runtime import surfaces as surfaces
from .runtime.batch.dataset import Dataset as Dataset
from .runtime.batch.dataset import open_dataset as open_dataset
from .runtime.cad.part import read_part as read_part
from .runtime.cad.reader import read_cad as read_cad
from .runtime.directions import fibonacci as fibonacci
from .runtime.directions import icosphere as icosphere
from .runtime.errors import GaussmapError as GaussmapError
from .runtime.errors import GaussmapWarning as GaussmapWarning
from .runtime.files.formats import read_samples as read_samples
from .runtime.fitting.fit import fit as fit
from .runtime.formulas import formulas as formulas
from .runtime.many import sample_many as sample_many
from .runtime.meshes.mesh import Mesh as Mesh
from .runtime.pictures.plot import plot as plot
from .runtime.samples import Samples as Samples
from .runtime.sampling import sample as sample
from .runtime.silhouette import silhouette as silhouette
from .runtime.splines.spline import Spline as Spline
from .runtime.stream import sample_stream as sample_stream
from .runtime.support.convolution import convolve as convolve
from .runtime.support.function import SupportFunction as SupportFunction
from .runtime.surface.surface import Surface as Surface
from .runtime.terrain.terrain import terrain as terrain

__version__: str
