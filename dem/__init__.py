"""Rigid blocks: on elastic joints load by load (`dem.static`) and in motion (`dem.dynamic`)."""
