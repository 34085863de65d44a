"""Both changelogs are what REP-132 asks for, read with the parser that bloom releases with."""

from pathlib import Path

import docutils.core
import pytest
from catkin_pkg.changelog import Changelog, populate_changelog_from_rst, version_and_date_from_title
from catkin_pkg.package import parse_package

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {"hgma_compensation": ROOT, "hgma_msgs": ROOT / "hgma_msgs"}
EACH = pytest.mark.parametrize("name", PACKAGES)
COMING = "Forthcoming"


def text_of(name):
    return (PACKAGES[name] / "CHANGELOG.rst").read_text(encoding="utf-8")


def sections(text):
    """Return the titles of the sections; a mistake of the markup, also a small one, is an error."""
    tree = docutils.core.publish_doctree(text, settings_overrides={"halt_level": 2, "report_level": 2})
    return [node.astext() for node in tree.findall(lambda node: node.tagname in ("title", "subtitle"))]


@EACH
def test_sections_are_what_is_coming_and_versions_with_their_dates(name):
    title, *titles = sections(text_of(name))
    assert title == f"Changelog for package {name}"
    versions = [version_and_date_from_title(one)[0] for one in titles if one != COMING]
    assert COMING in titles or parse_package(str(PACKAGES[name] / "package.xml")).version in versions
    assert titles.index(COMING) == 0 if COMING in titles else True


@EACH
def test_a_release_finds_what_is_coming_under_its_version(name):
    version = parse_package(str(PACKAGES[name] / "package.xml")).version
    title = f"{version} (2026-01-01)"
    released = text_of(name).replace(f"{COMING}\n{'-' * len(COMING)}", f"{title}\n{'-' * len(title)}")
    changelog = populate_changelog_from_rst(Changelog(name), released)
    contents = {found: content for found, _, content in changelog.foreach_version()}
    (bullets,) = contents[version]
    assert len(list(bullets)) >= 1
