"""The fields of hgma_msgs/CompensationState, for messages of rclpy and of rosbags alike."""

from typing import Any

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.compensated import Compensated

FILTER_CODES = {FilterMode.OFF: 0, FilterMode.SMOOTH: 1, FilterMode.BIAS: 2}


def state_fields(calibration: Calibration, result: Compensated, row: int) -> dict[str, Any]:
    """Return all fields but the header for one sample of a result."""
    # What is said of one sample costs that of one, and not that of a block.
    if len(result.values) > 1:
        result = result.take(np.array([row]))
    temperature, rate, product = result.features[0].tolist()
    return {
        "temperature": temperature,
        "temperature_rate": rate,
        "temperature_product": product,
        "channels": list(calibration.names),
        "drift": result.drift[0],
        "uncertainty": result.uncertainty[0],
        "innovation": result.innovation[0],
        "inside_calibrated_range": bool(result.inside_range[0]),
        "temperature_status": int(result.status[0]),
        "filter_mode": np.array([FILTER_CODES[c.filter.mode] for c in calibration.channels], dtype=np.uint8),
        "calibration_id": calibration.calibration_id,
    }
