"""Options of a training, the same for ``hgma train`` and ``hgma fleet``."""

from collections.abc import Callable, Mapping
from typing import Any

import click

from hgma_compensation.channels import parse_channels
from hgma_compensation.cli import options
from hgma_compensation.cli.paths import ChannelList
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.temperature.features import Product
from hgma_compensation.training.filter_design import TIME_CONSTANTS
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.methods import Method
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.train import TrainingOptions

DEFAULTS, SEARCH = TrainingOptions(), GeneticSettings()

OPTIONS = (
    click.option(
        "--method",
        type=click.Choice([m.value for m in Method]),
        default=DEFAULTS.method.value,
        show_default=True,
        help="rbf-ga: network found by a genetic search. rbf: network trained by gradient descent. polynomial: cubic "
        "in temperature, as PX4 and ArduPilot fit it. polynomial-rate: the cubic with rate terms.",
    ),
    click.option(
        "--channels",
        metavar="LIST",
        type=ChannelList(),
        help="Comma-separated, such as linear_acceleration.z. Default: all that the recordings have.",
    ),
    options.reference,
    click.option(
        "--seed",
        type=click.IntRange(min=0),
        default=DEFAULTS.seed,
        show_default=True,
        help="Same seed, same calibration.",
    ),
    click.option(
        "--delay",
        type=click.FloatRange(min=0.0, min_open=True),
        default=DEFAULTS.delay,
        show_default=True,
        help="Of ΔT = T(t) - T(t - delay), s.",
    ),
    click.option(
        "--product",
        type=click.Choice([p.value for p in Product]),
        default=DEFAULTS.product.value,
        show_default=True,
        help="Form of the input T·ΔT; reference is the paper's T·(T - 25 °C), which adds nothing to T.",
    ),
    click.option(
        "--filter",
        "filter_mode",
        type=click.Choice([m.value for m in FilterMode]),
        default=DEFAULTS.filter.value,
        show_default=True,
        help="Kalman stage after the drift model. smooth: filtered, shocks let through. "
        "bias: a slow bias is learned at rest.",
    ),
    click.option(
        "--filter-time-constant",
        type=click.FloatRange(min=0.0, min_open=True),
        help=f"s. Default: {TIME_CONSTANTS[FilterMode.SMOOTH]:g} for smooth, "
        f"{TIME_CONSTANTS[FilterMode.BIAS]:g} for bias.",
    ),
    click.option(
        "--centres",
        type=click.IntRange(1, 200),
        default=SEARCH.centres,
        show_default=True,
        help="Gaussians of the network.",
    ),
    click.option(
        "--generations",
        type=click.IntRange(min=1),
        default=SEARCH.generations,
        show_default=True,
        help="Longest search.",
    ),
    click.option(
        "--population",
        type=click.IntRange(min=4),
        default=SEARCH.population,
        show_default=True,
        help="Networks in each generation.",
    ),
)


def training_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options, in the order of OPTIONS."""
    for option in reversed(OPTIONS):
        function = option(function)
    return function


def settings_of(chosen: Mapping[str, Any], sensor_id: str | None = None) -> TrainingOptions:
    """Return the settings that the values of the options stand for; raises RefusedError for one that means nothing."""
    return TrainingOptions(
        method=Method(chosen["method"]),
        channels=parse_channels(chosen["channels"]) if chosen["channels"] is not None else None,
        reference=Reference.parse(chosen["reference_text"]),
        seed=chosen["seed"],
        sensor_id=sensor_id,
        delay=chosen["delay"],
        product=Product(chosen["product"]),
        filter=FilterMode(chosen["filter_mode"]),
        filter_time_constant=chosen["filter_time_constant"],
        genetic=GeneticSettings(chosen["centres"], chosen["population"], chosen["generations"]),
    )
