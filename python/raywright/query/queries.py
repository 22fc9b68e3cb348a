"""All queries of a scene."""

from __future__ import annotations

from .camera_queries import CameraQueries
from .cone_queries import ConeQueries
from .light_queries import LightQueries
from .medium_queries import MediumQueries
from .point_queries import PointQueries
from .previews import Previews
from .structure_queries import StructureQueries


class Queries(
    CameraQueries, PointQueries, ConeQueries, MediumQueries, LightQueries, StructureQueries, Previews
):
    """Queries of a scene; the first one compiles it. Those of rays come with those of cameras."""
