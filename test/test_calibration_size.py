import json
from dataclasses import replace

from builders import make_calibration, make_rbf

from hgma_compensation.calibration.document import LARGEST_FILE, MOST_COMMAS, with_id
from hgma_compensation.calibration.encoding import encode
from hgma_compensation.channels import CHANNELS


def test_the_largest_calibration_fits_into_a_file_with_margin():
    calibration = make_calibration(channels=CHANNELS)
    channels = tuple(replace(channel, drift=make_rbf(centres=500)) for channel in calibration.channels)
    document = encode(with_id(replace(calibration, channels=channels)))
    effect = {"effect": "e", "channel": CHANNELS[0], "parameters": dict.fromkeys("abcdefghij", -0.12345678901234567)}
    document["effects"] = [{**effect, "gains": [-0.12345678901234567] * 64}] * 64
    document["training"]["recordings"] *= 1000
    text = json.dumps(document, indent=1)
    assert 0.5 * LARGEST_FILE < len(text) < 0.95 * LARGEST_FILE
    assert 0.3 * MOST_COMMAS < text.count(",") < 0.8 * MOST_COMMAS
