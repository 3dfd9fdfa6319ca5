#!/usr/bin/env python3
"""Build the site. Usage: build_site.py --package FOLDER --out FOLDER --work FOLDER

--package  folder that holds the built Python package `abbe` (build/dev/python)
--out      where the pages are written; a site that was there is replaced, anything else refused
--work     folder for what is kept from run to run: copies of the documents, what Sphinx has read, outputs of notebooks

Exit code 77: packages of docs/site/requirements.txt are not installed, nothing was done.
"""

import argparse
import hashlib
import importlib.util
import logging
import os
import pathlib
import re
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
MARK = ".abbe-site"  # in the folder of a site, which may be replaced
NEEDED = ["furo", "ipykernel", "latex2mathml", "myst_nb", "myst_parser", "sphinx"]


def version() -> str:
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    match = re.search(r"project\(abbe VERSION ([0-9.]+)", text)
    assert match, "CMakeLists.txt states the version"
    return match.group(1)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Build the site of the documentation.")
    for name in ("package", "out", "work"):
        parser.add_argument(f"--{name}", type=lambda text: pathlib.Path(text).resolve(), required=True)
    return parser.parse_args()


def forget_outputs_of_another_package(options: argparse.Namespace) -> None:
    """Outputs of notebooks are kept until the notebook changes, which is seen without this, or the package."""
    digest = hashlib.sha256()
    for path in sorted(options.package.glob("abbe/*")):
        if path.suffix in (".py", ".so"):
            digest.update(path.read_bytes())
    stamp = options.work / "notebooks/made-by"
    if not stamp.is_file() or stamp.read_text(encoding="ascii") != digest.hexdigest():
        for folder in ("notebooks", "read"):
            shutil.rmtree(options.work / folder, ignore_errors=True)
        stamp.parent.mkdir(parents=True)
        stamp.write_text(digest.hexdigest(), encoding="ascii")


def settings_of_notebooks(folder: pathlib.Path) -> pathlib.Path:
    """Figures as drawings, which are sharp at any size; no words about connections within this machine."""
    profile = folder / "profile_default"
    profile.mkdir(parents=True, exist_ok=True)
    (profile / "ipython_kernel_config.py").write_text(
        "c.InlineBackend.figure_formats = {'svg'}\nc.IPKernelApp.log_level = 40\n", encoding="ascii"
    )
    return folder


def make_folder_of_site(folder: pathlib.Path) -> bool:
    """Removes the site that was there. False, with a message, where the folder holds anything else."""
    if folder.exists() and not (folder / MARK).is_file() and (not folder.is_dir() or any(folder.iterdir())):
        print(f"build_site: --out {folder}: expected a folder that is new, empty or holds a site", file=sys.stderr)
        return False
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / MARK).touch()
    return True


def main() -> int:
    options = arguments()
    if not make_folder_of_site(options.out):
        return 1
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        print(f"SKIPPED: {', '.join(missing)} not installed in this Python: .ci/python-venv site")
        return 77
    if not (options.package / "abbe/_core.pyi").is_file():
        print(f"build_site: {options.package}: expected the built package, with abbe/_core.pyi", file=sys.stderr)
        return 1

    sys.path.insert(0, str(HERE))
    import check_links
    import cpp_pages
    import python_pages
    import search_texts
    from security_policy import add_policies
    from sphinx.cmd.build import main as sphinx
    from stage import Stage

    stage = Stage(ROOT, options.work / "pages")
    stage.copy_documents()
    python_pages.write(stage, options.package / "abbe")
    cpp_pages.write(stage)
    stage.remove_others()

    forget_outputs_of_another_package(options)
    # Notebooks run in a process of their own, which finds the package and its settings by these.
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(options.package), os.environ.get("PYTHONPATH")]))
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    os.environ["IPYTHONDIR"] = str(settings_of_notebooks(options.work / "ipython"))
    os.environ["ABBE_SITE_VERSION"] = version()
    os.environ["ABBE_SITE_NOTEBOOKS"] = str(options.work / "notebooks")
    logging.getLogger("traitlets").setLevel(logging.WARNING)  # says which notebook it runs
    failed = sphinx(
        [
            "-q",
            "-E",
            "-W",
            "--keep-going",
            "-b",
            "html",
            "-c",
            str(HERE),
            "-d",
            str(options.work / "read"),
            str(options.work / "pages"),
            str(options.out),
        ]
    )
    if failed:
        return 1
    for leftover in (".buildinfo", "objects.inv"):
        (options.out / leftover).unlink(missing_ok=True)
    search_texts.write(options.out)
    add_policies(options.out)
    faults = list(check_links.faults(options.out))
    for page, message in faults:
        print(f"{page}: {message}", file=sys.stderr)
    pages = len(list(options.out.rglob("*.html")))
    print(f"{pages} pages, {len(faults)} broken links: {options.out / 'index.html'}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
