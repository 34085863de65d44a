"""Both package.xml are valid (REP-149) and agree with each other and with the Python metadata."""

import re
import warnings
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {"hgma_compensation": ROOT, "hgma_msgs": ROOT / "hgma_msgs"}
# The sequence that the schema of format 3 demands; catkin_pkg does not look at it, xmllint does.
SEQUENCE = [
    {"name"},
    {"version"},
    {"description"},
    {"maintainer"},
    {"license"},
    {"url"},
    {"author"},
    {"buildtool_depend", "build_depend", "depend", "exec_depend", "test_depend"},
    {"group_depend"},
    {"member_of_group"},
    {"export"},
]


@pytest.mark.parametrize("name", PACKAGES)
def test_is_valid_without_warnings(name):
    found = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        package = parse_package(str(PACKAGES[name] / "package.xml"), warnings=found)
        package.validate(warnings=found)
    assert found == []
    assert package.package_format == 3
    assert package.name == name
    assert package.licenses == ["Apache-2.0"]


@pytest.mark.parametrize("name", PACKAGES)
def test_elements_are_in_the_order_of_the_schema(name):
    children = ElementTree.parse(PACKAGES[name] / "package.xml").getroot()
    places = [next(i for i, tags in enumerate(SEQUENCE) if child.tag in tags) for child in children]
    assert places == sorted(places)


def test_all_versions_agree():
    sources = {
        "hgma_compensation/__init__.py": r'^__version__\s*=\s*"([^"]+)"',
        "package.xml": r"<version>([^<]+)</version>",
        "hgma_msgs/package.xml": r"<version>([^<]+)</version>",
        "hgma_msgs/pyproject.toml": r'^version\s*=\s*"([^"]+)"',
    }
    texts = {path: (ROOT / path).read_text(encoding="utf-8") for path in sources}
    versions = {path: re.search(sources[path], text, re.MULTILINE)[1] for path, text in texts.items()}
    assert len(set(versions.values())) == 1, versions


def test_every_interface_file_is_built():
    folder = ROOT / "hgma_msgs"
    built = set(re.findall(r'"((?:msg|srv)/[^"]+)"', (folder / "CMakeLists.txt").read_text(encoding="utf-8")))
    present = {str(path.relative_to(folder)) for kind in ("msg", "srv") for path in folder.glob(f"{kind}/*.{kind}")}
    assert built == present
