"""Slow inputs that fall silent, run ahead or stand still: what is held, and what the operator is told."""

import numpy as np
import pytest
from builders import EPOCH, LINEAR, make_calibration
from effect_calibrations import OFFERED

from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.node.diagnostics import DiagnosticReport
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.stamps import NANOSECONDS

pytestmark = pytest.mark.ros
STILL = [9.81] * 6


def at(second):
    return EPOCH + round(second * NANOSECONDS)


def live_with(*effects):
    live = LiveCompensation()
    live.install(make_calibration(channels=LINEAR[2:], effects=list(effects)))
    return live


def compensated(live, second):
    return live.compensate(*single_sample(at(second), STILL)).compensated


@pytest.mark.parametrize(
    ("name", "add", "need", "value"),
    [
        ("thermal_gradient", LiveCompensation.add_temperature_2, "temperature_2", 30.0),
        ("supply_voltage", LiveCompensation.add_supply_voltage, "supply_voltage", 5.5),
    ],
)
def test_an_input_that_falls_silent_for_a_minute_is_held_and_counted(name, add, need, value):
    effect = next(effect for effect in OFFERED[LINEAR[2]] if effect.name == name)
    needy, bare = live_with(AppliedEffect(LINEAR[2], effect, np.ones(effect.count))), live_with()
    add(needy, at(0), value)
    for second in range(101):
        for live in (needy, bare):
            live.add_temperature(at(second), 25.0)
    carried = [
        float((compensated(needy, s).drift - compensated(bare, s).drift)[0, 0]) for s in (59.0, 60.0, 60.5, 100.0)
    ]
    assert carried[0] != 0.0
    assert carried == pytest.approx([carried[0]] * 4)
    assert needy.counts[f"{need}_stale"] == 2


def test_a_thermistor_more_than_a_minute_ahead_is_counted():
    live = live_with()
    for second in range(200):
        live.add_temperature(at(second), 25.0)
    for second in (100.0, 138.9, 139.1):
        compensated(live, second)
    assert live.counts["temperature_ahead"] == 2


def test_one_value_for_ten_minutes_is_worth_a_remark_though_its_resolution_explain_it():
    live, report = live_with(), DiagnosticReport("node")
    said = []
    for second in range(0, 622, 2):
        live.add_temperature(at(second), 25.0 if second < 620 else 25.5)
        status = compensated(live, second).status[0]
        said.append("the thermistor has shown exactly" in report.status(live, "active", "", 1.0).message)
    assert status == TemperatureStatus.OK
    assert [2 * number for number, remark in enumerate(said) if remark] == list(range(602, 620, 2))
