"""Triangle meshes of polygons, and how good they are."""

from __future__ import annotations

# A function has the name of its file. Imported here, it has that name here, whatever is imported
# later: the file is loaded by then.
from geotween.mesh.advancing_front import advancing_front as advancing_front
from geotween.mesh.mesh import Mesh as Mesh
from geotween.mesh.quadtree import quadtree as quadtree
from geotween.mesh.quality import histogram as histogram
from geotween.mesh.quality import quality as quality
from geotween.mesh.quality import share_good as share_good

__all__ = ["Mesh", "advancing_front", "histogram", "quadtree", "quality", "share_good"]
