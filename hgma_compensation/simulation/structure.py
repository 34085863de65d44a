"""Natural frequencies of the sensing structure out of its geometry and the constants of silicon alone.

A square mass hangs on one beam at each side. That there are beams on all four sides follows from the paper's Table 2:
two modes at nearly the same frequency, 667 and 671 kHz. With all beams on two sides of a long mass they would differ.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = 16.67 / np.pi
"""Rotation of a half-plane's edge under the moment of a beam, in M / (E' t²) per width (O'Donnell 1960)."""

SHEAR_FACTOR = 5.0 / 6.0
"""Share of a rectangular section that carries shear (Timoshenko)."""


@dataclass(frozen=True)
class Silicon:
    """Beams along <110> in a (100) wafer, where piezoresistors answer most (Hopcroft, Nix, Kenny 2010).

    youngs_modulus, shear_modulus (out of the wafer's plane), shear_in_plane: Pa. density: kg/m³.
    """

    youngs_modulus: float = 169e9
    poisson_ratio: float = 0.064
    shear_modulus: float = 79.6e9
    shear_in_plane: float = 50.9e9
    density: float = 2330.0


@dataclass(frozen=True)
class Structure:
    """The paper's Table 1, m: one beam; the mass is twice 800 × 800 × 200 µm, taken as a block 400 µm high."""

    length: float = 350e-6
    width: float = 800e-6
    thickness: float = 80e-6
    side: float = 800e-6
    height: float = 400e-6
    silicon: Silicon = field(default_factory=Silicon)

    @property
    def mass(self) -> float:
        """The mass between the beams, kg."""
        return self.silicon.density * self.side**2 * self.height

    @property
    def beam_mass(self) -> float:
        """One beam, kg."""
        return self.silicon.density * self.length * self.width * self.thickness


@dataclass(frozen=True)
class BeamTheory:
    """What is counted beside bending: mass of the beams, shear, and the ends of a beam that give way."""

    beam_mass: bool = True
    shear: bool = True
    soft_frame: bool = True
    soft_mass: bool = True


EULER_BERNOULLI = BeamTheory(beam_mass=False, shear=False, soft_frame=False, soft_mass=False)
TIMOSHENKO = BeamTheory(soft_frame=False, soft_mass=False)


def beam_stiffness(structure: Structure, theory: BeamTheory) -> Array:
    """Return the stiffness (2, 2) at the mass' end of a beam, for deflection (m) and slope (rad)."""
    silicon, length = structure.silicon, structure.length
    modulus = silicon.youngs_modulus / (1.0 - silicon.poisson_ratio**2)
    area, inertia = structure.width * structure.thickness, structure.width * structure.thickness**3 / 12.0
    bend = modulus * inertia
    compliance = np.array([[length**3 / (3.0 * bend), length**2 / (2.0 * bend)], [0.0, length / bend]])
    compliance[1, 0] = compliance[0, 1]
    if theory.shear:
        compliance[0, 0] += length / (SHEAR_FACTOR * silicon.shear_modulus * area)
    root = ROOT / (modulus * structure.width * structure.thickness**2)
    if theory.soft_frame:
        compliance += root * np.array([[length**2, length], [length, 1.0]])
    if theory.soft_mass:
        compliance[1, 1] += root
    return np.asarray(np.linalg.inv(compliance))


def beam_inertia(structure: Structure, theory: BeamTheory) -> Array:
    """Return the mass (2, 2) of a beam at the mass' end, by its bending line (Rayleigh): 13/35 in deflection."""
    length = structure.length
    share = np.array([[156.0, -22.0 * length], [-22.0 * length, 4.0 * length**2]]) / 420.0
    return structure.beam_mass * share * theory.beam_mass


def translation(structure: Structure, theory: BeamTheory) -> float:
    """Return the frequency (Hz) of the mass moving out of the plane, √(K/M) with four guided beams."""
    stiffness = 4.0 * beam_stiffness(structure, theory)[0, 0]
    mass = structure.mass + 4.0 * beam_inertia(structure, theory)[0, 0]
    return float(np.sqrt(stiffness / mass) / (2.0 * np.pi))


def rocking(structure: Structure, theory: BeamTheory) -> float:
    """Return the frequency (Hz) of the mass turning about an axis in the plane; there are two, equal.

    Two beams bend at the edges of the mass, the two along the axis are twisted and bent in strips.
    """
    edge = np.array([0.5 * structure.side, -1.0])
    bending, inertia = beam_stiffness(structure, theory), beam_inertia(structure, theory)
    strips = structure.width**2 / 12.0
    torsion = structure.width * structure.thickness**3 / 3.0 * (1.0 - 0.63 * structure.thickness / structure.width)
    twist = structure.silicon.shear_in_plane * torsion / structure.length
    stiffness = 2.0 * (edge @ bending @ edge + bending[0, 0] * strips + twist)
    block = structure.mass * (structure.side**2 + structure.height**2) / 12.0
    total = block + 2.0 * (edge @ inertia @ edge + inertia[0, 0] * strips)
    return float(np.sqrt(stiffness / total) / (2.0 * np.pi))
