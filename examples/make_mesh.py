"""Mesh a wall and write it for other programs."""

from meshing import wall_mesh, write_mesh
from runningbond.compare import published_scene

wall = published_scene("panel-01")  # or, with `from runningbond.scene import read_scene`, read_scene("wall.toml")
mesh = wall_mesh(wall, cells=2)
write_mesh(mesh, wall, "panel-01.msh")
write_mesh(mesh, wall, "panel-01.vtu")
print(f"{len(mesh.points)} nodes, {len(mesh.triangles)} triangles, {len(mesh.interfaces)} joint elements")
