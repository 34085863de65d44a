"""The fields of hgma_msgs/CompensationState, for messages of rclpy and of rosbags alike."""

from typing import Any

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.compensated import Compensated

FILTER_CODES = {FilterMode.OFF: 0, FilterMode.SMOOTH: 1, FilterMode.BIAS: 2}


def state_fields(calibration: Calibration, result: Compensated, row: int) -> dict[str, Any]:
    """Return all fields but the header for one sample of a result."""
    temperature, rate, product = result.features[row].tolist()
    return {
        "temperature": temperature,
        "temperature_rate": rate,
        "temperature_product": product,
        "channels": list(calibration.names),
        "drift": np.ascontiguousarray(result.drift[row]),
        "uncertainty": np.ascontiguousarray(result.uncertainty[row]),
        "innovation": np.ascontiguousarray(result.innovation[row]),
        "inside_calibrated_range": bool(result.inside_range[row]),
        "temperature_status": int(result.status[row]),
        "filter_mode": np.array([FILTER_CODES[c.filter.mode] for c in calibration.channels], dtype=np.uint8),
        "calibration_id": calibration.calibration_id,
    }
