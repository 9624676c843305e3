"""The section and the material of a rod to the properties of its edges."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from ...scenario.language.geometry import Rod
from ...scenario.language.material import Material
from ...scenario.language.section import GivenSection, RectangularSection, RoundSection, TubeSection
from ...scenario.text.tree import KeyPath
from ...sections.rods import (
    RodProperties,
    Section,
    rectangular_section,
    rod_properties,
    round_section,
    tube_section,
)
from .varying import Sampler

# Parts of an edge bend, twist and stretch in series; mass and area add up.
_COMPLIANT = ("axial", "bending_1", "bending_2", "torsional")
# The second point of Gauss is the middle of the edge.
_MIDDLE = 3


def properties_of(rod: Rod, path: KeyPath, material: Material, sample: Sampler) -> RodProperties:
    """Stiffness and inertia of the edges of a rod.

    Args:
        rod: As in the scenario.
        path: Its key path.
        material: Its material.
        sample: Reads values on its edges.

    Raises:
        ScenarioError: A value that varies is wrong somewhere on the rod.
    """
    points = _at_points(rod, path, material, sample)
    cells = sample.cells
    edges = {one.name: cells.mean(getattr(points, one.name)) for one in fields(points)}
    edges |= {name: cells.in_series(getattr(points, name)) for name in _COMPLIANT}
    radius = points.radius
    return replace(points, **edges | ({"radius": radius[_MIDDLE]} if radius.ndim else {}))


def _at_points(rod: Rod, path: KeyPath, material: Material, sample: Sampler) -> RodProperties:
    """Properties at the points of all edges, shape (P, E), or one number for all."""
    shape: Section
    here = path if rod.section is None else (*path, "section")
    density = sample(material.density, ("materials", rod.material, "density"), "density")
    match rod.cross_section:
        case RoundSection() as s:
            shape = round_section(sample(s.radius, (*here, "radius"), "length"))
        case TubeSection() as s:
            outer = sample(s.outer_radius, (*here, "outer_radius"), "length")
            inner = sample(s.inner_radius, (*here, "inner_radius"), "length")
            sample.refuse(
                np.asarray(inner >= outer),
                inner,
                (*here, "inner_radius"),
                "length",
                "must be less than the outer one",
            )
            shape = tube_section(outer, inner)
        case RectangularSection() as s:
            torsion = s.torsion_constant
            shape = rectangular_section(
                sample(s.width, (*here, "width"), "length"),
                sample(s.thickness, (*here, "thickness"), "length"),
                None if torsion is None else sample(torsion, (*here, "torsion_constant"), "torsion constant"),
            )
        case GivenSection() as s:
            mass = sample(s.mass_per_length, (*here, "mass_per_length"), "mass per length")
            inertia = (*here, "rotary_inertia_per_length")
            return RodProperties(
                axial=np.asarray(sample(s.axial_stiffness, (*here, "axial_stiffness"), "force")),
                bending_1=np.asarray(
                    sample(s.bending_stiffness_1, (*here, "bending_stiffness_1"), "bending stiffness")
                ),
                bending_2=np.asarray(
                    sample(s.bending_stiffness_2, (*here, "bending_stiffness_2"), "bending stiffness")
                ),
                torsional=np.asarray(
                    sample(s.torsional_stiffness, (*here, "torsional_stiffness"), "bending stiffness")
                ),
                mass_per_length=np.asarray(mass),
                polar_per_length=np.asarray(
                    sample(s.rotary_inertia_per_length, inertia, "inertia per length")
                ),
                area=np.asarray(mass / density),
                radius=np.asarray(sample(s.radius, (*here, "radius"), "length")),
            )
    modulus = sample(material.youngs_modulus, ("materials", rod.material, "youngs_modulus"), "pressure")
    return rod_properties(shape, modulus, material.poisson_ratio, density)
