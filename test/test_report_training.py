from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import make_recording
from report_diagnosis import NASTY, Checker, words
from report_pages import BAG, CALIBRATION, QUICK, html_of, small_training, trained

from hgma_compensation.cli.main import main
from hgma_compensation.drift.radial_basis import basis
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.report import training_sentences as sentences
from hgma_compensation.report.search_record import SearchRecord
from hgma_compensation.report.training_report import training_page
from hgma_compensation.report.training_result import training_result
from hgma_compensation.training.comparison import ridge_penalty
from hgma_compensation.training.genetic import PLAIN_PENALTY
from hgma_compensation.training.methods import SEARCHES, Method
from hgma_compensation.training.polynomial_fit import polynomial_fitness
from hgma_compensation.training.ridge import solve_ridge
from hgma_compensation.training.train import train

FEW = ["--generations", "3", "--population", "8", "--centres", "3", "--delay", "10"]


@pytest.fixture(scope="module")
def result():
    return small_training()


def test_page_is_well_formed_and_needs_nothing_but_itself(result):
    checked = Checker(html_of("training"))
    assert checked.tags.count("svg") == 6 * len(result.channels) + 1
    assert not {"script", "link", "img", "iframe"} & set(checked.tags)
    assert all(link.startswith("#") for link in checked.links)
    assert not [word for word in ("@import", "http:", "https:", "<b>", NASTY) if word in html_of("training")]


def test_page_says_what_was_learned_and_what_to_do_next(result):
    text = words(html_of("training")).replace("\u00a0", " ")
    assert f"Training of sensor {NASTY}" in text
    assert result.calibration.calibration_id in text
    for channel in result.channels:
        assert f"{channel.chosen.cross_validated:.3g}"[:5] in text
    for part in (
        "cubic in temperature",
        "by gradient descent",
        "genetic search (chosen)",
        "What to do next",
        "hgma evaluate",
    ):
        assert part in text
    assert "nan" not in text


def test_errors_on_left_out_folds_are_those_that_training_reports(result):
    for channel in result.channels:
        assert channel.chosen.method is Method.RBF_GA
        assert channel.chosen.cross_validated == pytest.approx(channel.calibration.error.cross_validated, rel=1e-6)
        assert channel.chosen.fit == pytest.approx(channel.calibration.error.fit, rel=1e-12)
        for each in channel.results[:2]:
            known = polynomial_fitness(channel.features, channel.target, each.drift.exponents, result.folds)
            assert each.cross_validated == pytest.approx(known, rel=1e-6)
        folds = [each.of_folds(result.folds) for each in channel.results]
        counts = np.bincount(result.folds.index)
        for each, errors in zip(channel.results, folds, strict=True):
            assert np.sqrt(np.sum(counts * np.square(errors)) / counts.sum()) == pytest.approx(each.cross_validated)


@pytest.mark.parametrize("penalty", [1e-7, 1e-4, 1e-2])
def test_the_penalty_of_a_fit_is_read_off_its_weights(result, penalty):
    channel = result.channels[0]
    network = channel.calibration.drift
    columns = basis(network.scaling.apply(channel.features), network.centres, network.widths)
    count = len(network.weights)
    penalties = np.r_[np.full(count, penalty), np.full(columns.shape[1] - count, PLAIN_PENALTY)]
    weights = solve_ridge(columns, channel.target, penalties)
    fitted = replace(network, weights=weights[:count], bias=float(weights[count]), linear=weights[count + 1 :])
    np.testing.assert_allclose(ridge_penalty(fitted, channel.features, channel.target), penalties, rtol=1e-4)


def test_the_search_is_heard_as_it_went():
    recordings, calibration, search = trained()
    for channel in calibration.channels:
        errors = search.errors(channel.name)
        assert 1 < len(errors) <= SEARCHES * QUICK.genetic.generations
        assert np.all(np.diff(errors) <= 0.0)
        assert errors[-1] <= channel.error.cross_validated * (1.0 + 1e-9)
        assert search.seconds(channel.name) > 0.0
    assert SearchRecord().seconds("none") is None
    assert train(recordings, QUICK).calibration_id == calibration.calibration_id


def test_methods_that_were_not_asked_for_are_those_that_training_would_give():
    recordings, calibration, _ = trained()
    plain = train(recordings, replace(QUICK, method=Method.POLYNOMIAL))
    result = training_result(recordings, plain, QUICK.genetic, SearchRecord())
    for channel, asked in zip(result.channels, calibration.channels, strict=True):
        searched = channel.results[-1]
        assert searched.method is Method.RBF_GA
        assert searched.drift.weights.tobytes() == asked.drift.weights.tobytes()
        assert channel.search[-1] == pytest.approx(searched.cross_validated, rel=1e-6)


def test_another_method_that_is_better_is_said():
    recordings, _, _ = trained()
    calibration = train(recordings, replace(QUICK, method=Method.RBF, channels=("linear_acceleration.z",)))
    result = training_result(recordings, calibration, QUICK.genetic, SearchRecord())
    (channel,) = result.channels
    assert channel.chosen.method is Method.RBF
    assert channel.best.method is not Method.RBF
    assert sentences.kind(channel) == "bad"
    assert all(each.seconds is not None for each in channel.results)
    text = words(training_page(result, [BAG], CALIBRATION))
    assert f"train with --method {channel.best.method.value} ." in text
    assert "another method is better" in text


def test_what_the_recordings_do_not_show_is_said(result):
    said = " ".join(sentences.gaps(result))
    assert "Nearly all ramps have one rate" in said
    assert "hardly ever held" in said
    blocks = result.blocks
    heating = replace(result, blocks=blocks.select(blocks.features[:, 1] > 0.0))
    assert "never cool" in " ".join(sentences.gaps(heating))
    random = np.random.default_rng(1)
    count = 3000
    rate = np.tile([0.01, 0.0, -0.01, 0.0, 0.03, -0.03], count // 6)
    features = np.column_stack([random.uniform(-10.0, 60.0, count), rate, np.zeros(count)])
    everything = replace(
        result,
        blocks=replace(
            blocks,
            features=features,
            time=np.arange(count) * 5.0,
            recording=np.zeros(count, dtype=np.int64),
            values=np.zeros((count, 2)),
        ),
    )
    assert "nothing obvious is missing" in sentences.gaps(everything)[0]


def run(*arguments):
    return main([str(argument) for argument in arguments])


@pytest.fixture
def bag(tmp_path):
    recording = make_recording(1, 1200.0, 4.0, 1.0, cycles=2.0, channels=("linear_acceleration.z",), noise=0.01)
    write_recording(recording, tmp_path / "bag")
    return tmp_path / "bag"


def test_calibration_is_the_same_byte_for_byte_with_and_without_a_report(bag, capsys):
    folder = bag.parent
    assert run("train", bag, "-o", folder / "without.json", *FEW, "--json", folder / "1.json") == 0
    arguments = ["--json", folder / "2.json", "--report", folder / "page.html"]
    assert run("train", bag, "-o", folder / "with.json", *FEW, *arguments) == 0
    assert (folder / "with.json").read_bytes() == (folder / "without.json").read_bytes()
    assert (folder / "2.json").read_bytes() == (folder / "1.json").read_bytes()
    text = words((folder / "page.html").read_text(encoding="utf-8"))
    assert "Comparison of methods" in text
    assert "How the search went" in text
    assert "page.html: report" in capsys.readouterr().out


def test_interrupted_comparison_leaves_the_calibration_and_says_so(bag, monkeypatch, capsys):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("hgma_compensation.report.training_result.compare_methods", interrupt)
    calibration, page = bag.parent / "cal.json", bag.parent / "page.html"
    assert run("train", bag, "-o", calibration, "--method", "polynomial", "--report", page) == 130
    assert "cal.json is written" in capsys.readouterr().err
    assert calibration.exists()
    assert not page.exists()


def test_a_calibration_is_not_replaced_by_a_page(bag, capsys):
    calibration = Path(bag.parent / "cal.json")
    assert run("train", bag, "-o", calibration, "--report", calibration) == 2
    assert "such as cal.html" in capsys.readouterr().err
    assert not calibration.exists()
