"""Terms whose stencils come and go; a scene without contact loads none of their code."""

from __future__ import annotations

from ..frozen import frozen
from ..model.term import ChangingTerm
from ..run.touched import Touched
from ..run.validity import Check
from .scene import Scene
from .structure.structure import Structure


@frozen
class Changing:
    """What comes and goes, with its place in the energy account.

    Attributes:
        terms: The terms.
        storing: Names of the bound terms that store the energy of contact.
        rubbing: Names of those that turn energy into heat.
        touched: Reads what they leave in states; None without them.
        checks: What a run must not pass unseen.
        warnings: What is doubtful at the start.
    """

    terms: tuple[ChangingTerm, ...] = ()
    storing: tuple[str, ...] = ()
    rubbing: tuple[str, ...] = ()
    touched: Touched | None = None
    checks: tuple[Check, ...] = ()
    warnings: tuple[str, ...] = ()


def make_changing(scene: Scene, structure: Structure) -> Changing:
    """Contact, if the scene has any.

    Raises:
        ScenarioError: It asks for what cannot be.
    """
    if scene.scenario.contact is None:
        return Changing()
    from ..contact.contact import WORST
    from ..contact.pairs.rod_pairs import PAIRS
    from ..contact.pairs.surface_pairs import LISTED
    from ..contact.terms import FRICTION, NORMAL
    from .contact.contact import make_contact
    from .contact.doubts import depth_check, start_doubts
    from .contact.face_doubts import crossing_checks
    from .contact.surface_doubts import surface_checks

    contact = make_contact(scene, structure)
    return Changing(
        terms=(contact,),
        storing=(NORMAL,),
        rubbing=() if contact.friction is None else (FRICTION,),
        touched=Touched(
            WORST, (PAIRS, LISTED), contact.pairs, contact.lines.nodes[:, 0], contact.rule.tolerance
        ),
        checks=(depth_check(scene, contact), *crossing_checks(contact), *surface_checks(scene, contact)),
        warnings=tuple(start_doubts(scene, structure, contact)),
    )
