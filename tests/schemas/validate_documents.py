"""Validates what the command writes for programs against the published schemas.

    validate_documents.py --abbe PROGRAM --examples FOLDER --out FOLDER

Digital calibration certificates (DCC 3.2.1 with D-SI 2.1.0, by PTB, LGPL): ABBE_DCC_SCHEMA and ABBE_DSI_SCHEMA name
dcc.xsd and SI_Format.xsd; without them both are fetched from ptb.de. Results in QIF 3.0: ABBE_QIF_SCHEMA names
QIFDocument.xsd of the schemas that DMSC distributes. Exit code 77: nothing was validated.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import urllib.error
import urllib.request

DCC_ADDRESS = "https://ptb.de/dcc/v3.2.1/dcc.xsd"
DSI_NAMESPACE = "https://ptb.de/si"
FACTS = """[report]
language = "{language}"
number = "1"
customer = {{ name = "A & B", address = "1 Street" }}
machine = {{ maker = "M", model = "<X>", serial_number = "7" }}
laboratory = {{ name = "L", address = "2 Street", country = "DE" }}
operator = "T"
date = "2026-11-28"
"""
#: Evaluations of the examples, each of another test.
EVALUATIONS = {
    "positioning": ["positioning", "evaluate/linear.csv", "--instrument-um-per-m", "0.6", "--tolerance", "A_um=20"],
    "rotary": ["positioning", "evaluate/rotary.csv"],
    "temperature-variation": ["etve", "evaluate/etve.csv"],
    "spindle-distortion": ["spindle-distortion", "evaluate/spindle.csv"],
    "axis-distortion": ["axis-distortion", "evaluate/axis_warming.csv"],
    "location-distortion": ["location-distortion", "warm_up/r-test.study.toml", "--stop-min", "240"],
    "diagonals": ["diagonals", "evaluate/diagonals.csv"],
    "circular": ["circular", "evaluate/circular.csv", "--radius-mm", "150", "--u-reading-um", "0.2"],
    "rotation": ["rotation", "evaluate/rotation.csv"],
    "straightness": ["straightness", "evaluate/straightness.csv"],
    "squareness": ["squareness", "evaluate/squareness.csv", "--u-square-urad", "1", "--u-reading-um", "0.5"],
    "sections": ["contour", "laser_engraver/sections.csv", "--u-origin-um", "2"],
    "linkage": ["linkage", "laser_engraver/five-steps.csv", "--machine", "machines/yin-engraver-u.machine.toml",
                "--exit-to-axis-mm", "120", "--board-mm", "4"],
}


def run(abbe, *words):
    """Exit code 1 is an answer, such as a tolerance that is exceeded."""
    done = subprocess.run([abbe, *map(str, words)], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"FAILED: abbe {' '.join(map(str, words))}: {done.returncode}: {done.stderr}")


def make_documents(abbe, examples, out):
    """Every kind of certificate and of QIF results, in all languages. @returns two lists of files"""
    certificates, results = [], []
    for language in ("en", "de", "zh", "ja"):
        facts = out / f"facts-{language}.toml"
        facts.write_text(FACTS.format(language=language), encoding="utf-8")
        for name, (kind, readings, *options) in EVALUATIONS.items():
            certificate, result = out / f"{name}-{language}.xml", out / f"{name}-{language}.qif"
            options = [examples / word if word.endswith(".toml") else word for word in options]
            run(abbe, "evaluate", kind, examples / readings, *options, "--facts", facts, "--customer-report", certificate,
                "--qif", result, "--force")
            certificates.append(certificate)
            results.append(result)
    customer = examples / "customer_report"
    certificate, result = out / "before-and-after.xml", out / "before-and-after.qif"
    run(abbe, "evaluate", "positioning", customer / "after.csv", "--before", customer / "before.csv",
        "--instrument-um-per-m", "0.4", "--environment-um", "0.3", "--facts", customer / "facts.toml",
        "--customer-report", certificate, "--qif", result, "--force")
    study = out / "study.qif"
    run(abbe, "run", customer / "mill.study.toml", "-o", out / "mill", "--qif", study, "--force")
    return [*certificates, certificate, out / "mill/calibration-certificate.xml"], [*results, result, study]


def named_schema(variable):
    named = os.environ.get(variable)
    if named and not pathlib.Path(named).is_file():
        sys.exit(f"FAILED: {variable}={named}: there is no such file")
    return named


def schemas(xmlschema):
    """Those of certificates and of QIF; None: not at hand."""
    dcc, dsi, qif = (named_schema(f"ABBE_{name}_SCHEMA") for name in ("DCC", "DSI", "QIF"))
    certificate = None
    if dcc:
        certificate = xmlschema.XMLSchema(dcc, locations={DSI_NAMESPACE: dsi} if dsi else None)
    else:
        try:
            urllib.request.urlopen(DCC_ADDRESS, timeout=20).close()
            certificate = xmlschema.XMLSchema(DCC_ADDRESS)
        except (urllib.error.URLError, OSError) as error:
            print(f"SKIPPED certificates: no ABBE_DCC_SCHEMA, and {DCC_ADDRESS} cannot be fetched: {error}")
    if not qif:
        print("SKIPPED QIF results: no ABBE_QIF_SCHEMA")
    return certificate, xmlschema.XMLSchema(qif) if qif else None


def faults_of(schema, path):
    return [f"{path.name}: {error.path}: {error.reason}" for error in schema.iter_errors(str(path))]


def without_first(text, element):
    """A document that is wrong: it lacks an element that the schema requires."""
    begin, close = text.index(f"<{element}"), f"</{element}>"
    return text[:begin] + text[text.index(close) + len(close):]


def main():
    parser = argparse.ArgumentParser()
    for name in ("--abbe", "--examples", "--out"):
        parser.add_argument(name, required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    try:
        import xmlschema
    except ImportError:
        print("SKIPPED: Python has no module xmlschema (Debian: python3-xmlschema)")
        return 77
    certificate_schema, result_schema = schemas(xmlschema)
    if not certificate_schema and not result_schema:
        return 77
    shutil.rmtree(arguments.out, ignore_errors=True)
    arguments.out.mkdir(parents=True)
    certificates, results = make_documents(arguments.abbe, arguments.examples, arguments.out)
    faults, counts = [], []
    for what, schema, documents, required in (("certificates", certificate_schema, certificates, "dcc:coreData"),
                                              ("QIF results", result_schema, results, "QPId")):
        if not schema:
            continue
        counts.append(f"{len(documents)} {what}")
        faults += [fault for document in documents for fault in faults_of(schema, document)]
        wrong = arguments.out / f"wrong-{documents[0].name}"
        wrong.write_text(without_first(documents[0].read_text(encoding="utf-8"), required), encoding="utf-8")
        if not faults_of(schema, wrong):
            faults.append(f"{wrong.name}: has no {required}, which the schema does not find")
    for fault in faults:
        print(f"FAILED {fault}")
    if not faults:
        print(f"valid: {', '.join(counts)}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
