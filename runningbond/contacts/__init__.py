"""Contact detection: the sides of blocks that face each other at finite displacements."""
