"""The check of links finds each of its faults and nothing on good pages; the policy of a page has the scripts in it."""

import contextlib
import io
import os
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from build_site import make_folder_of_site  # noqa: E402
from check_links import faults  # noqa: E402
from python_groups import groups  # noqa: E402
from python_source import Name, Source  # noqa: E402
from security_policy import add_policies  # noqa: E402
from stage import Stage  # noqa: E402

GOOD = {
    "index.html": '<h1 id="top">A</h1><a href="sub/b.html#here">b</a><a href="#top">up</a>'
    '<a href="search.html?q=a">s</a>'
    '<a href="https://example.org/x?y#z">o</a><a href="mailto:a@example.org">m</a><img src="data:image/png;base64,AA">'
    '<link rel="next" href="sub/b.html"><img src="a%20b.svg">',
    "sub/b.html": '<p id="here"></p><a href="../index.html">a</a><script src="../s.js?v=1"></script>',
    "search.html": "",
    "a b.svg": "",
    "s.js": "",
}


class Folder(unittest.TestCase):
    def test_only_a_site_is_replaced(self) -> None:
        with tempfile.TemporaryDirectory() as name, contextlib.redirect_stderr(io.StringIO()) as said:
            folder = pathlib.Path(name)
            self.assertTrue(make_folder_of_site(folder / "new/site"))
            (folder / "new/site/index.html").touch()
            self.assertTrue(make_folder_of_site(folder / "new/site"))
            self.assertFalse((folder / "new/site/index.html").exists())
            self.assertFalse(make_folder_of_site(folder / "new"))
            self.assertTrue((folder / "new/site").is_dir())
            (folder / "file").touch()
            self.assertFalse(make_folder_of_site(folder / "file"))
            self.assertTrue((folder / "file").is_file())
        self.assertIn("expected a folder that is new, empty or holds a site", said.getvalue())


class Pages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name) / "site"

    def faults_with(self, **pages):
        for name, text in {**GOOD, **{name.replace("__", "."): text for name, text in pages.items()}}.items():
            path = self.folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return [f"{page}: {message}" for page, message in faults(self.folder)]

    def test_good_pages_have_no_faults(self):
        self.assertEqual(self.faults_with(), [])

    def test_each_fault_is_found(self):
        wrong = {
            '<a href="missing.html">': "there is no such file",
            '<a href="sub/">': "there is no such file",
            '<a href="../outside.html">': "there is no such file",
            '<img src="missing.png">': "there is no such file",
            '<a href="#nowhere">': "no element with this id",
            '<a href="sub/b.html#nowhere">': "no element with this id",
            '<a href="/index.html">': "expected a path relative to the page",
            '<a href="file:///etc/hosts">': "expected http, https, mailto or a path",
            '<a href="javascript:1">': "expected http, https, mailto or a path",
            '<a href="https://nohost/">': "expected the name of a host",
            '<a href="https://example.org:port/">': "the port is no number",
            '<a href="https://example.org/a b">': "white space",
            '<script src="https://example.org/x.js"></script>': "loaded from another host",
            '<link rel="stylesheet" href="//example.org/x.css">': "loaded from another host",
            '<i id="a"></i><i id="a"></i>': "two elements have the id 'a'",
        }
        (self.folder.parent / "outside.html").write_text("", encoding="utf-8")
        for element, words in wrong.items():
            found = self.faults_with(index__html=GOOD["index.html"] + element)
            self.assertEqual(len(found), 1, f"{element}: {found}")
            self.assertIn(words, found[0])

    def test_a_page_without_a_link_to_it_is_found(self):
        self.assertEqual(
            self.faults_with(lost__html='<a href="index.html">'), ["lost.html: no link leads to this page"]
        )

    def test_the_policy_allows_the_scripts_of_the_page_and_no_others(self):
        head = '<meta charset="utf-8">'
        self.faults_with(index__html=f"{head}<script>alert(1)</script><script src='s.js'></script><style>a{{}}</style>")
        for name in ("sub/b.html", "search.html"):
            (self.folder / name).write_text(head, encoding="utf-8")
        add_policies(self.folder)
        page = (self.folder / "index.html").read_text(encoding="utf-8")
        self.assertIn(
            "default-src 'none'; script-src 'self' 'sha256-bhHHL3z2vDgxUt0W3dWQOrprscmda2Y5pLsLg4GF+pI='; "
            "style-src-elem "
            "'self' 'sha256-",
            page,
        )
        self.assertEqual(page.count("sha256-"), 2)
        (self.folder / "search.html").write_text("no place", encoding="utf-8")
        self.assertRaises(ValueError, add_policies, self.folder)

    def test_documents_are_adapted_outside_code_only(self):
        root = self.folder.parent / "root"
        (root / "docs/images").mkdir(parents=True)
        (root / "data.txt").write_text("1", encoding="utf-8")
        stage = Stage(root, self.folder)
        link = "[a](../README.md#b) [c](x.md) [d](images) [e](../data.txt) [f](https://example.org/README.md) [g](#h)"
        self.assertEqual(
            stage.adapted("docs/x.md", f"{link}\n```sh\n{link}\n```\n"),
            "[a](../index.md#b) [c](x.md) d [e](../data.txt) [f](https://example.org/README.md) [g](#h)\n"
            f"```sh\n{link}\n```\n",
        )
        self.assertEqual((self.folder / "data.txt").read_text(encoding="utf-8"), "1")

    def test_names_go_to_the_row_that_they_belong_to(self):
        document = self.folder.parent / "python.md"
        rows = "| names | about | in C++ |\n|---|---|---|\n| `fit` | fits | `abbe/a.h` |\n| `Map` | maps | |\n"
        document.write_text(f"## What there is\n\n{rows}", encoding="utf-8")
        names = {
            "LIMITS": Name("LIMITS", "data"),
            "Fit": Name("Fit", "class"),
            "Map": Name("Map", "class", "Within LIMITS."),
            "Setting": Name("Setting", "class"),
            "fit": Name("fit", "function", gives={"Fit"}, takes=["Setting"]),
            "read_map": Name("read_map", "function", gives={"Map"}),
            "threads": Name("threads", "function", gives={"int"}, takes=["Map"]),
        }
        found = [(group.listed, group.names) for group in groups(document, names)]
        self.assertEqual(
            found,
            [(["fit"], ["fit", "Fit", "Setting"]), (["Map"], ["Map", "LIMITS", "read_map"]), ([], ["threads"])],
        )
        del names["Map"]
        self.assertRaisesRegex(ValueError, "Map", groups, document, names)

    def test_signatures_are_read_as_a_reader_writes_them(self):
        path = self.folder.parent / "_core.pyi"
        path.write_text(
            """
class Axis:
    \"\"\"One axis.\"\"\"

    def __init__(self, arg: str, /, *, travel_mm: collections.abc.Sequence[float] = (0.0, 1.0)) -> None: ...

    @property
    def point_mm(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
        \"\"\"Where.\"\"\"

    @point_mm.setter
    def point_mm(self, arg: object, /) -> None: ...

    @staticmethod
    def read(path: str | os.PathLike[str]) -> abbe._core.Axis: ...

def turn(axis: Axis, by: typing.Optional[float] = None) -> "Axis": ...
""",
            encoding="utf-8",
        )
        names = Source(path).names()
        axis, turn = names["Axis"], names["turn"]
        self.assertEqual(axis.signatures, ["(arg: str, *, travel_mm: Sequence[float]=(0.0, 1.0))"])
        point, read = axis.members
        self.assertEqual((point.type, point.flags, point.doc), ("NDArray[numpy.float64]", ["settable"], "Where."))
        self.assertEqual((read.flags, read.signatures), (["staticmethod"], ["(path: str | os.PathLike[str]) -> Axis"]))
        self.assertEqual(turn.signatures, ["(axis: Axis, by: float | None=None) -> Axis"])
        self.assertIn("Axis", turn.gives)


if __name__ == "__main__":
    unittest.main()
