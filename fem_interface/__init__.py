"""Interface finite elements: deformable blocks from scikit-fem operators, reduced to modes block by block."""
