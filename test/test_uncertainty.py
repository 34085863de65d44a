import numpy as np
import pytest
from builders import make_calibration, make_polynomial
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.pipeline.uncertainty import DriftUncertainty
from hgma_compensation.stamps import NANOSECONDS

CALIBRATION = make_calibration()
OWN = CALIBRATION.channels[0].error.unseen
MIDDLE = CALIBRATION.calibrated_range.middle


def evaluate(status, features=MIDDLE, age=0.1):
    result = DriftUncertainty(CALIBRATION).evaluate(features[None], np.array([age]), np.array([status], dtype=np.uint8))
    assert result.shape == (1, 3)
    return result[0]


def test_with_a_usable_temperature_it_is_the_calibrations_own_error():
    np.testing.assert_array_equal(evaluate(TemperatureStatus.OK), [OWN] * 3)


def test_outside_the_range_it_grows_with_the_distance_as_the_drift_does_inside():
    box = CALIBRATION.calibrated_range
    grid = np.repeat(MIDDLE[None], 400, axis=0)
    grid[:, 0] = np.linspace(box.lower[0], box.upper[0], 400)
    half_spans = np.array([0.5 * np.ptp(c.drift.evaluate(grid)) for c in CALIBRATION.channels])
    width = 0.5 * (box.upper[0] - box.lower[0])
    for half_widths in (0.1, 1.0, 3.0):
        beyond = MIDDLE.copy()
        beyond[0] = box.upper[0] + half_widths * width
        found = evaluate(TemperatureStatus.OUT_OF_RANGE, beyond)
        np.testing.assert_allclose(found, np.hypot(OWN, half_spans * half_widths), rtol=0.02)


def test_a_held_temperature_is_known_less_and_less_until_it_may_be_anywhere_in_the_range():
    ages = [11.0, 20.0, 60.0, 1e3, 1e6]
    found = np.array([evaluate(TemperatureStatus.STALE, age=age) for age in ages])
    assert (np.diff(found, axis=0) >= 0.0).all()
    np.testing.assert_array_equal(found[-1], found[-2])
    assert (found[0] > OWN).all()


def test_without_any_temperature_the_drift_may_be_anywhere():
    missing = evaluate(TemperatureStatus.MISSING, age=np.inf)
    assert (missing > 20.0 * OWN).all()
    np.testing.assert_array_equal(evaluate(TemperatureStatus.INVALID, age=np.inf), missing)


def test_while_settling_only_the_product_is_unknown():
    settling = evaluate(TemperatureStatus.SETTLING)
    assert (settling > OWN).all()
    assert (settling < evaluate(TemperatureStatus.MISSING, age=np.inf)).all()


def test_a_flat_drift_is_as_certain_without_a_thermistor():
    flat = make_polynomial().__class__(make_polynomial().scaling, np.zeros((1, 3), dtype=np.int64), np.array([5.0]))
    channels = tuple(type(c)(c.name, flat, c.reference, c.filter, c.error) for c in CALIBRATION.channels)
    calibration = type(CALIBRATION)(**{**CALIBRATION.__dict__, "channels": channels})
    found = DriftUncertainty(calibration).evaluate(
        MIDDLE[None], np.array([np.inf]), np.array([TemperatureStatus.MISSING], dtype=np.uint8)
    )
    np.testing.assert_allclose(found, [[OWN] * 3])


@given(
    status=st.lists(st.sampled_from(TemperatureStatus), min_size=1, max_size=5),
    seed=st.integers(0, 99),
)
def test_rows_do_not_depend_on_each_other_and_are_finite(status, seed):
    random = np.random.default_rng(seed)
    features = MIDDLE + random.normal(0.0, 100.0, (len(status), 3))
    age = np.array([np.inf if s is TemperatureStatus.MISSING else random.exponential(100.0) for s in status])
    codes = np.array(status, dtype=np.uint8)
    uncertainty = DriftUncertainty(CALIBRATION)
    whole = uncertainty.evaluate(features, age, codes)
    assert np.isfinite(whole).all()
    assert (whole >= OWN).all()
    for row in range(len(status)):
        part = slice(row, row + 1)
        alone = uncertainty.evaluate(features[part], age[part], codes[part])
        assert whole[part].tobytes() == alone.tobytes()


@pytest.mark.parametrize(("second", "larger"), [(70, False), (75, True), (300, True)])
def test_the_pipeline_says_it_with_every_sample(second, larger):
    pipeline = Pipeline(CALIBRATION, live=True)
    for at in range(1, 65):
        pipeline.add_temperature(at * NANOSECONDS, 25.0)
    result = pipeline.compensate(np.array([second * NANOSECONDS]), np.zeros((1, 3)))
    assert bool((result.uncertainty > OWN).all()) == larger
    assert (result.added_variance(0) is not None) == larger
