"""The public names and where they are defined; `__init__.py` loads them from here."""

from . import symbolic as symbolic
from .runtime import directions as directions
from .runtime.base import errors as errors
from .runtime.base.errors import GaussmapError as GaussmapError
from .runtime.base.errors import GaussmapWarning as GaussmapWarning
from .runtime.directions import fibonacci as fibonacci
from .runtime.directions import icosphere as icosphere
from .runtime.directions.regions import Reach as Reach
from .runtime.fitting.fit import fit as fit
from .runtime.map import GaussMap as GaussMap
from .runtime.samples.fields import Component as Component
from .runtime.samples.samples import Samples as Samples
from .runtime.spline.spline import Spline as Spline
from .runtime.surface import surfaces as surfaces
from .runtime.surface.surface import Surface as Surface
from .tools import curves as curves
from .tools import gauss_map as gauss_map
from .tools.batch.dataset import Dataset as Dataset
from .tools.batch.dataset import open_dataset as open_dataset
from .tools.batch.many import sample_many as sample_many
from .tools.cad.part import Part as Part
from .tools.cad.part import read_part as read_part
from .tools.cad.reader import read_cad as read_cad
from .tools.commands.formula_texts import formulas as formulas
from .tools.files.formats import read_samples as read_samples
from .tools.gauss_map.silhouette import silhouette as silhouette
from .tools.meshes.mesh import Mesh as Mesh
from .tools.pictures.plot import plot as plot
from .tools.sampling.sample import sample as sample
from .tools.sampling.stream import sample_stream as sample_stream
from .tools.support.convolution import convolve as convolve
from .tools.support.function import SupportFunction as SupportFunction
from .tools.terrain.terrain import terrain as terrain

__version__: str
