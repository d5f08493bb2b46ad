"""What `import gaussmap` promises: every public name, and nothing heavy."""

import ast
import copy
import pickle
import subprocess
import sys
from pathlib import Path

import gaussmap as gm
import pytest

NAMES = (
    "Component Dataset GaussMap Mesh Part Reach Samples Spline SupportFunction Surface "
    "GaussmapError GaussmapWarning fit sample sample_many sample_stream read_cad read_part "
    "read_samples "
    "open_dataset icosphere fibonacci convolve silhouette plot terrain curves directions errors "
    "gauss_map surfaces formulas symbolic"
)
NAMESPACES = {
    "curves": "Curve CurveBranches CurveReport CurveSamples CurveSpline SupportFunction fit sample",
    "directions": "cap circle covering_radius fibonacci healpix icosphere polygon random",
    "errors": "FileError GaussmapError GaussmapWarning InputError MissingExtraError "
    "MissingFieldError SurfaceError UnknownNameError",
    "gauss_map": "BoundaryArc GaussianImage GaussianImages ImageCurve "
    "ParabolicLine ParabolicPoint ParabolicPoints PatchClass Piece classify_patches "
    "parabolic_lines parabolic_points split_patch",
}


def test_these_are_the_public_names() -> None:
    assert dir(gm) == sorted(NAMES.split())
    for name in NAMES.split():
        assert getattr(gm, name) is not None
    assert gm.__version__.count(".") == 2
    with pytest.raises(AttributeError, match="No gaussmap attribute smaple"):
        gm.smaple  # pyright: ignore[reportAttributeAccessIssue]  # noqa: B018


@pytest.mark.parametrize("space", NAMESPACES)
def test_these_are_the_names_of_a_namespace(space: str) -> None:
    module = getattr(gm, space)
    assert dir(module) == sorted(module.__all__) == sorted(NAMESPACES[space].split())
    for name in module.__all__:
        assert getattr(module, name) is not None


def test_type_checkers_see_the_public_names() -> None:
    """A stub makes a name public by `as`; the loader reads the names before it."""
    tree = ast.parse(Path(str(gm.__file__)).with_suffix(".pyi").read_text(encoding="ascii"))
    names = [alias for x in ast.walk(tree) if isinstance(x, ast.ImportFrom) for alias in x.names]
    assert sorted(x.name for x in names) == sorted(NAMES.split())
    assert all(x.name == x.asname for x in names)


def test_sampling_loads_no_other_tools_and_no_heavy_libraries() -> None:
    """The map loads none; methods of samples that tools define are loaded when called."""
    code = """
import sys
import gaussmap as gm
torus = gm.surfaces.torus()
heavy = "sympy", "matplotlib", "pandas", "pyvista", "tqdm", "trimesh"
tools = lambda: {x.split(".")[2] for x in sys.modules if x.startswith("gaussmap.tools.")}
gm.GaussMap(torus, cells=(16, 16)).points([[0, 0, 1]]).summary()
print(sorted(tools()))
gm.sample(torus, normals=gm.icosphere(8))
print("scipy.spatial" in sys.modules)
for request in ({"count": 200}, {"coverage": 0.5}, {"angle": 30.0}, {"normals": [[0, 0, 1]]}):
    samples = gm.sample(torus, cells=(16, 16), **request)
for density in ("gauss", "aligned", "balanced", "uniform"):
    samples = gm.sample(torus, 200, cells=(16, 16), density=density)
chunks = list(gm.sample_stream(torus, 200, cells=(16, 16)))
len(chunks), samples.summary(), samples.coverage()
print(sorted(tools()))
gm.SupportFunction, gm.curves.sample, gm.directions.cap, gm.gauss_map.Piece, gm.read_samples
samples.weights(), samples.mesh()
print("meshes" in tools(), "scipy.spatial" in sys.modules, [x for x in heavy if x in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    printed = ["[]", "False", "['density', 'sampling']", "True True []"]
    assert done.stdout.splitlines() == printed


def test_formulas_by_name() -> None:
    assert gm.formulas["envelope"].source.startswith("eq")
    assert set(gm.formulas) >= {"forms", "support_function", "curvature", "triangle"}
    assert gm.formulas is gm.formulas
    for copied in (copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))):
        assert copied(gm.formulas) is gm.formulas


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nope", r"^there is no formula 'nope'\. See `gaussmap formulas` for all names\.$"),
        ("envelop", r"^there is no formula 'envelop'; did you mean envelope.*\? See `gaussmap "),
        (3, r"^there is no formula 3\."),
    ],
)
def test_a_formula_of_no_such_name(name: str, message: str) -> None:
    with pytest.raises(gm.errors.UnknownNameError, match=message):
        gm.formulas[name]
    assert name not in gm.formulas
    assert gm.formulas.get(name) is None
    assert repr(gm.formulas) == f"Formulas({len(gm.formulas)} formulas)"
