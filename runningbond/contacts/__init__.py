"""Who touches whom: the sides of blocks that face each other at finite displacement."""
