import pytest
from structure_elements import first_frequency

from hgma_compensation.simulation.structure import (
    EULER_BERNOULLI,
    TIMOSHENKO,
    BeamTheory,
    Structure,
    rocking,
    translation,
)

PAPER = 408e3
"""Hz, first mode of the paper's finite elements; 667 and 671 kHz are the rocking ones."""

MIDDLE = 2
"""Layer of the beams in the finite elements, out of five."""


def test_the_mass_is_that_of_the_paper():
    assert Structure().mass == pytest.approx(5.96e-7, rel=2e-3)


def test_the_first_mode_follows_from_geometry_and_silicon_alone():
    assert translation(Structure(), BeamTheory()) == pytest.approx(PAPER, rel=0.1)


def test_the_two_rocking_modes_follow_too():
    for of_the_paper in (667e3, 671e3):
        assert rocking(Structure(), BeamTheory()) == pytest.approx(of_the_paper, rel=0.1)


def test_with_a_rigid_frame_as_finite_elements_clamp_it_both_are_within_three_percent():
    clamped = BeamTheory(soft_frame=False)
    assert translation(Structure(), clamped) == pytest.approx(PAPER, rel=0.03)
    assert rocking(Structure(), clamped) == pytest.approx(667e3, rel=0.03)


def test_plain_euler_bernoulli_is_far_too_stiff():
    # √(4·12EI/l³ / M) / 2π by hand: E' = 169.7 GPa, I = 3.413e-17 m⁴, M = 5.965e-7 kg.
    assert translation(Structure(), EULER_BERNOULLI) == pytest.approx(524.8e3, rel=1e-3)
    assert translation(Structure(), TIMOSHENKO) == pytest.approx(463.6e3, rel=1e-3)


@pytest.fixture(scope="module")
def elements():
    """Return the frequencies of three-dimensional finite elements, up and down and rocking, clamped beams."""
    return first_frequency(MIDDLE, rocking=False), first_frequency(MIDDLE, rocking=True)


def test_beam_theory_agrees_with_finite_elements_of_the_same_clamped_structure(elements):
    clamped = BeamTheory(soft_frame=False)
    assert translation(Structure(), clamped) == pytest.approx(elements[0], rel=0.04)
    assert rocking(Structure(), clamped) == pytest.approx(elements[1], rel=0.07)


def test_finite_elements_of_the_geometry_give_the_modes_of_the_paper(elements):
    assert elements[0] == pytest.approx(PAPER, rel=0.06)
    assert elements[1] == pytest.approx(667e3, rel=0.1)
