"""A recording with all inputs, as what happens one after the other to a LiveCompensation."""

from effect_calibrations import with_all_inputs

from hgma_compensation.pipeline.live_samples import single_sample

RECORDING = with_all_inputs()


def events():
    """Return all samples of the recording in the order of their stamps, each as a function of a LiveCompensation."""
    slow = [
        (stamp, lambda live, name=name, sample=(stamp, value): getattr(live, f"add_{name}")(*sample))
        for name in ("temperature", "temperature_2", "supply_voltage")
        for series in [getattr(RECORDING, name)]
        for stamp, value in zip(series.stamps.tolist(), series.values.tolist(), strict=True)
    ]
    fast = [
        (stamp, lambda live, sample=(stamp, row): live.compensate(*single_sample(*sample)))
        for stamp, row in zip(RECORDING.stamps.tolist(), RECORDING.values, strict=True)
    ]
    return [happen for _, happen in sorted(slow + fast, key=lambda event: event[0])]


EVENTS = events()


def outputs(live, steps):
    """Let things happen and return the values and drifts of all outputs as bytes."""
    results = [happen(live) for happen in steps]
    return b"".join(r.compensated.values.tobytes() + r.compensated.drift.tobytes() for r in results if r is not None)
