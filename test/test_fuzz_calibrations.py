import json
import random

import pytest

from benchmarks.soak.fuzz import oracle, slice, trial_run
from benchmarks.soak.fuzz.mutator import Seeds
from benchmarks.soak.fuzz_calibrations import CORPUS
from hgma_compensation.calibration.document import parse_calibration
from hgma_compensation.errors import RefusedError

ACCEPTED, REFUSED = (sorted((CORPUS / verdict).iterdir()) for verdict in ("accepted", "refused"))
NETWORK = json.loads((CORPUS / "accepted" / "network.json").read_text())


@pytest.mark.parametrize("path", ACCEPTED, ids=lambda path: path.stem)
def test_a_valid_document_of_the_corpus_is_accepted_and_compensates(path):
    assert trial_run.problem_of(parse_calibration(path.read_bytes()), random.Random(1)) is None


@pytest.mark.parametrize("path", REFUSED, ids=lambda path: path.stem)
def test_what_the_fuzzer_once_found_is_refused(path):
    with pytest.raises(RefusedError):
        parse_calibration(path.read_bytes())


def test_a_short_run_finds_nothing():
    seeds = Seeds([path.read_bytes() for path in ACCEPTED], [path.read_bytes() for path in REFUSED])
    outcome = slice.run(seeds, count=600, number=0, seed=7)
    assert outcome.findings == []
    assert sum(outcome.counts.values()) == 600
    assert {verdict for _, verdict in outcome.counts} == {"accepted", "refused"}


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"note": "mine"}, "against the schema"),
        ({"sensor_id": "red\x1b[2J"}, "is no printable text"),
        ({"channels": NETWORK["channels"] * 2}, "a channel is given twice"),
        ({"calibrated_range": {**NETWORK["calibrated_range"], "temperature": [9.0, 9.0]}}, "temperature is empty"),
        ({"training": {**NETWORK["training"], "more": [[[float(10**308) * 10]]]}}, "Infinity is no JSON"),
    ],
)
def test_the_judge_objects_to_what_the_parser_should_refuse(change, reason):
    document = {**NETWORK, **change}
    document["calibration_id"] = oracle.content_id(document)
    assert reason in oracle.problem_of(json.dumps(document).encode())


def test_the_judge_objects_to_an_id_that_is_not_that_of_the_content():
    assert "its id" in oracle.problem_of(json.dumps({**NETWORK, "sensor_id": "another"}).encode())
