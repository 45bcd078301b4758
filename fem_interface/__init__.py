"""Interface finite elements: deformable blocks on scikit-fem operators, reduced to modes block by block."""
