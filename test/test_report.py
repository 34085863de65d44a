import re
from dataclasses import replace

import numpy as np
import pytest
from report_diagnosis import NASTY, Checker, calibration_before, lagging_recording, small_diagnosis, words

from hgma_compensation.cli.diagnose import sentence
from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.diagnosis.verdict import Judgement, Verdict
from hgma_compensation.errors import RefusedError
from hgma_compensation.report.diagnosis_report import diagnosis_page, write_diagnosis_report
from hgma_compensation.report.markup import element, inner, table
from hgma_compensation.report.remainder import looks_like
from hgma_compensation.report.sentences import headline
from hgma_compensation.training.methods import Method
from hgma_compensation.training.train import TrainingOptions, train


@pytest.fixture(scope="module")
def diagnosis():
    return small_diagnosis()


@pytest.fixture(scope="module")
def page(diagnosis):
    return diagnosis_page(diagnosis, title=f"Diagnosis {NASTY}", original=calibration_before())


def with_verdict(diagnosis, verdict, **changes):
    """Return the channel's diagnosis as one that left the calibration alone."""
    channel = diagnosis.channels[0]
    judgement = Judgement(verdict, "the reason", changes.pop("helped", False))
    return replace(channel, judgement=judgement, effects=(), after=channel.before, **changes)


def test_page_is_well_formed(page):
    checked = Checker(page)
    assert checked.tags.count("svg") >= 8
    assert checked.tags.count("html") == checked.tags.count("title") == checked.tags.count("h1") == 1


def test_page_needs_nothing_but_itself(page):
    checked = Checker(page)
    assert not {"script", "link", "img", "iframe"} & set(checked.tags)
    assert checked.links
    assert all(link.startswith("#") for link in checked.links)
    assert not [word for word in ("@import", "http:", "https:") if word in page]


def test_references_inside_of_the_page_have_a_target(page):
    targets = {link[1:] for link in Checker(page).links}
    assert all(f'id="{target}"' in page for target in targets)


def test_page_is_small(page):
    assert len(page.encode()) < 600_000


def test_names_out_of_data_are_escaped(page):
    assert not [word for word in (NASTY, "<i>", "<b>") if word in page]
    assert f"Diagnosis {NASTY}" in words(page)


def test_page_says_what_was_found(page, diagnosis):
    text = words(page)
    assert diagnosis.channels[0].verdict is Verdict.EXPLAINED
    assert "The calibration lacks one effect: thermal lag of the structure behind the thermistor" in text
    for part in (
        diagnosis.calibration.calibration_id,
        calibration_before().calibration_id,
        "Error on the hold-out",
        "All candidates",
        "humidity",
        "Allan deviation",
        "seed",
        "no supply voltage",
    ):
        assert part.lower() in text.lower()


def test_same_diagnosis_gives_the_same_page(diagnosis, page):
    assert diagnosis_page(diagnosis, title=f"Diagnosis {NASTY}", original=calibration_before()) == page


def test_original_calibration_may_be_unknown(diagnosis):
    assert "Augmented calibration" in words(diagnosis_page(diagnosis, title="t"))


@pytest.mark.parametrize(
    ("verdict", "said"),
    [(Verdict.NO_EFFECT, "What is left is noise"), (Verdict.UNEXPLAINED, "nothing in the catalogue fits it")],
)
def test_other_verdicts_have_their_sentence(diagnosis, verdict, said):
    found = with_verdict(diagnosis, verdict)
    bare = replace(found, findings=replace(found.findings, found=(), state=found.findings.before))
    text = words(diagnosis_page(replace(diagnosis, channels=(bare,)), title="t"))
    assert said in headline(found)
    assert said in text
    assert "left as it was" in text
    assert ("What it looks like." in text) == (verdict is Verdict.UNEXPLAINED)


def test_partial_explanation_has_its_sentence(diagnosis):
    channel = diagnosis.channels[0]
    partly = with_verdict(diagnosis, Verdict.UNEXPLAINED, helped=True, partial=channel.effects)
    assert headline(partly).startswith("The residual is only partly explained: thermal lag")


def test_several_channels_get_an_overview(diagnosis):
    channel = diagnosis.channels[0]
    noise = with_verdict(diagnosis, Verdict.NO_EFFECT)
    text = diagnosis_page(replace(diagnosis, channels=(channel, noise)), title="t")
    assert "All channels" in words(text)
    assert {"#channel-0", "#channel-1"} <= set(Checker(text).links)


def test_an_effect_whose_input_only_follows_is_said_to_be_undecided(diagnosis):
    channel = diagnosis.channels[0]
    assert channel.undecided == ()
    found = replace(channel.findings.found[0], undecided=("thermal_gradient",))
    doubtful = replace(channel, findings=replace(channel.findings, found=(found,)))
    assert doubtful.as_json()["undecided"] == ["thermal_gradient"]
    said = sentence(doubtful)
    assert "thermal_gradient fits as well and cannot be told apart here (that would take a second thermometer" in said
    text = words(diagnosis_page(replace(diagnosis, channels=(doubtful,)), title="t"))
    assert "moved only as the temperature and its rate make it" in text
    assert "heat from another side" in text
    noise = with_verdict(diagnosis, Verdict.NO_EFFECT, findings=doubtful.findings)
    assert noise.undecided == ()


def test_runners_up_are_named_with_the_way_to_tell_them_apart(diagnosis):
    channel = diagnosis.channels[0]
    found = replace(channel.findings.found[0], runners_up={"timing_offset": 3.0})
    doubtful = replace(channel, findings=replace(channel.findings, found=(found,)))
    text = words(diagnosis_page(replace(diagnosis, channels=(doubtful,)), title="t"))
    assert "fits nearly as well" in text
    assert "ripple of an oven's controller" in text


def test_one_cycle_is_reported_with_its_families():
    recordings = [lagging_recording("one", 1, 1.0)]
    calibration = train(recordings, TrainingOptions(method=Method.POLYNOMIAL))
    diagnosis = diagnose(recordings, calibration, lagging_recording("two", 2, 1.0))
    assert diagnosis.channels[0].findings.spectra is not None
    text = words(diagnosis_page(diagnosis, title="t"))
    assert "family of memories" in text
    assert "fewer than two temperature cycles" in text


def test_file_appears_whole(diagnosis, tmp_path):
    path = tmp_path / "report.html"
    path.write_text("old")
    write_diagnosis_report(diagnosis, path, title="t")
    assert path.read_text(encoding="utf-8").endswith("</html>\n")
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.html"]


def test_file_that_cannot_be_written_is_refused(diagnosis, tmp_path):
    with pytest.raises(RefusedError, match="cannot be written"):
        write_diagnosis_report(diagnosis, tmp_path / "nowhere" / "report.html", title="t")


def test_markup_escapes_all_but_markup():
    assert element("p", "<&", class_='a"b') == '<p class="a&quot;b">&lt;&amp;</p>'
    assert inner(element("b", "x"), "<y>") == "<b>x</b>&lt;y&gt;"
    assert "<script>" not in table(["<script>"], [["<script>"]])


def test_the_slow_part_of_a_hold_out_is_never_more_than_its_error(diagnosis):
    channel = diagnosis.channels[0]
    recordings, held_out = channel.residues_after
    ramp = np.linspace(-1e4, 1e4, len(held_out.residual))  # m/s², a baseline that bends away outside of its data
    astray = replace(held_out, residual=held_out.residual + ramp)
    assert astray.slow.excess > 1000.0
    said = " ".join(looks_like(replace(channel, residues_after=(recordings, astray))))
    stated = float(re.search(r"slow part is ([\d.]+)", said).group(1))
    assert stated <= 1.01 * max(channel.error_after, recordings.slow.excess)
