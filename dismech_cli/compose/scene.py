"""The scene that every stage of composing reads: what was said, the bodies, the places, the laws."""

from __future__ import annotations

from ..errors import ScenarioError
from ..frozen import frozen
from ..scenario.language.scenario import Scenario
from ..scenario.load import LoadedScenario
from ..scenario.text.tree import KeyPath
from .bodies.geometry import Geometry, assemble_geometry
from .bodies.joints import weld_joints
from .laws import ToLaw, make_laws
from .places import Places, find_places


@frozen
class Scene:
    """All that is known before anything is decided.

    Attributes:
        loaded: The scenario.
        geometry: Its bodies, joined.
        places: What its selections find.
        laws: Laws of time from those of the scenario.
    """

    loaded: LoadedScenario
    geometry: Geometry
    places: Places
    laws: ToLaw

    @property
    def scenario(self) -> Scenario:
        """What the user said."""
        return self.loaded.scenario

    def error(self, path: KeyPath, message: str) -> ScenarioError:
        """An error that points to a key path, for the caller to raise."""
        return self.loaded.error(path, message)


def make_scene(loaded: LoadedScenario) -> Scene:
    """Put the bodies together and find all places on them.

    Raises:
        ScenarioError: A mesh is unusable, a joint does not fit, or selections find nothing.
    """
    geometry = weld_joints(loaded, assemble_geometry(loaded))
    return Scene(loaded, geometry, find_places(loaded, geometry), make_laws(loaded))
