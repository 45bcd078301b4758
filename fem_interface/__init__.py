"""Deformable blocks: scikit-fem operators, modes of block templates, and the interface finite element model."""
