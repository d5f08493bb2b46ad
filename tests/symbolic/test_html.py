"""The page of formulas for browsers: valid, complete, alone, the same everywhere."""

import os
import re
import subprocess
import sys
from collections import Counter
from functools import cache
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest
from gaussmap.symbolic import files, formulas, html, latex, surfaces
from gaussmap.symbolic.simplify import straight_line

math_core = pytest.importorskip("math_core")

DOCTYPE = "<!DOCTYPE html>\n"
NAMES = (*formulas, *surfaces.CATALOGUE)
EACH_FORMULA = pytest.mark.parametrize("formula", formulas.values(), ids=formulas)
GENERATED = sorted(files.GENERATED.glob("*.py"))
KERNELS = sorted(path for folder in html.KERNELS for path in folder.glob("*.py"))


@cache
def page() -> str:
    return html.page()


@cache
def root() -> ElementTree.Element:
    """Read the page as XML, which it is too: what is not closed or not escaped is an error."""
    return ElementTree.fromstring(page().removeprefix(DOCTYPE))


@cache
def articles() -> dict[str, ElementTree.Element]:
    return {x.attrib["id"]: x for x in root().iter("article")}


def text_of(element: ElementTree.Element | None) -> str:
    assert element is not None
    return " ".join("".join(element.itertext()).replace(html.WORD_JOINER, "").split())


def rows_of(name: str) -> dict[str, str]:
    """Return what is said about a formula or surface."""
    terms, values = (articles()[name].findall(f"dl/{x}") for x in ("dt", "dd"))
    return dict(zip(map(text_of, terms), map(text_of, values), strict=True))


# --- the page -------------------------------------------------------------------------------------


class Balance(HTMLParser):
    """Fails where HTML, rather than XML, sees an element that is not closed in its order."""

    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.open, self.seen = [], Counter()

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.seen[tag] += 1
        assert len({name for name, _ in attrs}) == len(attrs)

    def handle_startendtag(self, tag, attrs):
        # In HTML, `/>` closes the elements of MathML and those that are empty by nature.
        assert tag in {"meta", "mspace", "mrow", "mtd", "mi"}
        self.seen[tag] += 1

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.mark.slow
def test_html_is_balanced():
    assert page().startswith(DOCTYPE + '<html lang="en">')
    parser = Balance()
    parser.feed(page())
    parser.close()
    assert parser.open == []
    assert {parser.seen[tag] for tag in ("title", "style", "h1", "nav", "main")} == {1}
    assert parser.seen["article"] == len(formulas) + len(surfaces.CATALOGUE)
    assert root().findtext("head/title")


def test_anchors():
    """Every anchor is there once, and no link leads nowhere."""
    anchors = [x.attrib["id"] for x in root().iter() if "id" in x.attrib]
    assert len(set(anchors)) == len(anchors)
    links = [x.attrib["href"] for x in root().iter("a")]
    assert {x.removeprefix("#") for x in links} <= set(anchors)
    assert all(x.startswith("#") for x in links)
    contents = [x.attrib["href"].removeprefix("#") for x in root().findall("body/nav//li/ul//a")]
    assert contents == list(NAMES)
    labels = [x.attrib["aria-labelledby"] for x in root().iter() if "aria-labelledby" in x.attrib]
    assert set(labels) <= set(anchors)


def test_nothing_is_loaded_or_run():
    loading = {"script", "link", "img", "iframe", "object", "embed"}
    assert loading.isdisjoint(x.tag for x in root().iter())
    for element in root().iter():
        for name, value in element.attrib.items():
            assert not name.startswith("on")
            assert name != "src"
            assert "url(" not in value
    (style,) = root().iter("style")
    assert not re.search(r"url\(|@import", style.text or "")
    assert not re.search(r"https?:|//[a-z]|javascript:", page())


@pytest.mark.slow
def test_the_same_everywhere():
    code = "import sys; from gaussmap.symbolic import html; "
    code += "sys.stdout.buffer.write(html.page().encode())"
    environment = os.environ | {"PYTHONHASHSEED": "1", "LC_ALL": "C"}
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, check=True
    )
    assert run.stdout.decode() == page()


# --- what is said about a formula -----------------------------------------------------------------


@EACH_FORMULA
def test_formula(formula):
    article, rows = articles()[formula.name], rows_of(formula.name)
    assert text_of(article.find("header/h3/a/code")) == formula.name
    assert text_of(article.find("header/p")) == formula.source
    assert list(rows)[:4] == ["Inputs", "Outputs", "Operations", "Functions"]
    assert [*rows][4:] in ([], ["Part of"], ["Kernels"], ["Part of", "Kernels"])
    # Mathematics is written differently there, but the words are the same.
    words = re.sub(r"`(\w+)`", r"\1", formula.description).split("$")[::2]
    sentence = text_of(article.find("p"))
    for part in words:
        assert " ".join(part.split()) in sentence
    assert len(rows["Inputs"].split(", ")) == len(formula.inputs)
    assert len(rows["Outputs"].split(", ")) == len(formula.outputs)
    code = straight_line(formula)
    counts = f"{code.operations_before} as written, {code.operations_after} as run"
    assert rows["Operations"] == counts


@pytest.mark.parametrize("surface", surfaces.CATALOGUE.values(), ids=surfaces.CATALOGUE)
def test_surface(surface):
    article, rows = articles()[surface.name], rows_of(surface.name)
    assert text_of(article.find("p")) == surface.sentence
    assert article.find("header/p") is None
    assert list(rows)[-3:] == ["Ends", "Operations", "Functions"]
    sentences = [x.sentence.removesuffix(".") for x in surface.parameters]
    assert list(rows.values())[:-3] == sentences
    defaults = [str(x.default) for x in surface.parameters]
    assert [x.split("=")[1] for x in list(rows)[:-3]] == defaults
    assert rows["Functions"] == f"surface_jets.{surface.name}, surfaces.{surface.name}"


@pytest.mark.parametrize("path", GENERATED, ids=lambda path: path.name)
def test_each_generated_function_is_listed(path):
    """Read generated/ line by line: a function is listed with its formula."""
    for line in path.read_text(encoding="utf-8").splitlines():
        if (head := re.match(r"def (\w+)\(", line)) and head[1] in NAMES:
            assert f"{path.stem}.{head[1]}" in rows_of(head[1])["Functions"].split(", ")


@pytest.mark.parametrize("path", KERNELS, ids=lambda path: path.name)
def test_each_call_of_a_kernel_is_listed(path):
    """Read all kernels line by line: who calls a function is listed with its formula."""
    text = path.read_text(encoding="utf-8")
    imported = re.findall(r"^from \.\.\.generated\.(\w+) import ([^()]*?|\([^()]*\))$", text, re.M)
    names = {x: file for file, y in imported for x in re.findall(r"\w+", y) if x in formulas}
    function = ""
    for line in text.partition("\n__all__")[2].splitlines():
        if head := re.match(r"def (\w+)\(", line):
            function = head[1]
        for name in names:
            if re.search(rf"(?<![\w.]){name}\(", line) and not head:
                assert f"{path.stem}.{function}" in rows_of(name)["Kernels"].split(", ")


@pytest.mark.parametrize(
    ("name", "key", "value"),
    [
        ("forms", "Functions", "patch.forms"),
        ("support_function", "Functions",
         "patch.support_function, support_function.support_function"),
        ("curvature", "Part of", "sample, curvature_at, branch, curvature_at_normal"),
        ("hessian_at", "Kernels", "support.hessians_of_patches"),
        ("branch", "Kernels", "support.branches_of_patch"),  # compiled as it is
    ],
)  # fmt: skip
def test_uses(name, key, value):
    assert rows_of(name)[key] == value


# --- mathematics ----------------------------------------------------------------------------------

BOLD = {"a": 0x1D41A, "A": 0x1D400}


def bold(letter: str) -> str:
    start = "a" if letter.islower() else "A"
    return chr(BOLD[start] + ord(letter) - ord(start))


@pytest.mark.parametrize("name", NAMES)
def test_mathematics(name):
    """What LaTeX writes is there: rows, fractions, roots, indices, bold letters, brackets."""
    (display,) = articles()[name].findall("div/math")
    assert display.get("display") == "block"
    source = next(x.aligned for s in latex.sections().values() for x in s if x.name == name)
    tags = Counter(x.tag for x in display.iter())
    assert tags["mtr"] == source.count("\\\\") + 1 + source.count("\\begin{pmatrix}")
    assert tags["mfrac"] == len(re.findall(r"\\d?frac\b", source))
    assert tags["msqrt"] == source.count("\\sqrt")
    assert tags["msup"] + tags["msubsup"] == source.count("^")
    assert tags["msub"] + tags["msubsup"] == len(re.findall(r"(?<!\\)_", source))
    assert not tags["merror"]
    text = text_of(display)
    letters = "".join(re.findall(r"\\mathbf\{(\w+)\}", source))
    expected = Counter(map(bold, letters))
    assert {x: text.count(x) for x in expected} == expected
    columns = source.count("\\begin{pmatrix}")  # their brackets are drawn by the stylesheet
    assert columns == len(display.findall(".//mtable//mtable"))
    for opening, closing in ("()", "[]"):
        shown = re.sub(r"\\\\\[\w+\]", "", source)
        assert text.count(opening) == shown.count(opening)
        assert text.count(closing) == shown.count(closing)


@pytest.mark.parametrize("name", NAMES)
def test_equations_are_aligned(name):
    """Each row has two cells, the second begins with the relation or is the rest of a row."""
    (table,) = articles()[name].findall("div/math/mtable")
    for row in table.findall("mtr"):
        left, right = row.findall("mtd")
        assert "right" in left.attrib["style"]
        assert "left" in right.attrib["style"]
        assert (right[0].text in {"=", "∈"}) == bool(text_of(left))


def test_an_index_that_is_a_word_is_one_upright_word():
    """An <mi> of several letters is upright; one for each letter would be their product."""
    (display,) = articles()["offset_curvature"].findall("div/math")
    assert [x.text for x in display.iter("mi")].count("offset") == 2


def test_mathml_has_no_foreign_characters():
    """No remains of LaTeX, and no styles of letters that browsers do not know."""
    for element in root().iter("math"):
        assert not re.search(r"[\\&${}]", text_of(element))
        assert {x.get("mathvariant", "normal") for x in element.iter()} == {"normal"}


def test_unknown_latex_is_an_error():
    with pytest.raises(math_core.LatexError):
        html.mathml(r"\unheardof{x}")


def test_text_is_escaped():
    assert html._text("a < b & $c$, `torus`") == (
        'a &lt; b &amp; <math><mi>c</mi></math>, <a href="#torus"><code>torus</code></a>'
    )
