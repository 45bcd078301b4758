"""Pictures of walls and mechanisms, and files for ParaView.

- `flat`: vector drawings of a wall and of an outcome's mechanism, with matplotlib only.
- `render`: pictures and films of a result folder, painted by PyVista (`pyvista_painter`, `pyvista_figure`).
- `time_series`: VTU and PVD files of a run (`frame`, `vtk_grids`).

All of them draw a `deformed_shape`. `mechanism` checks an outcome's motion before it is drawn, `joint_state` finds
which joints slide and open, and `annotations` and `captions` add supports, loads and text.
"""
