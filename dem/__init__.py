"""Rigid blocks: load by load (`dem.static`), in motion (`dem.dynamic`), and their limit (`runningbond.limit`)."""

from runningbond.limit import limit, limit_nonassociated

__all__ = ["limit", "limit_nonassociated"]
