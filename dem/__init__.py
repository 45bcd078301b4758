"""Rigid blocks: static load paths (`dem.static`), dynamics (`dem.dynamic`), limit analysis (`runningbond.limit`)."""

from runningbond.limit import limit, limit_nonassociated

__all__ = ["limit", "limit_nonassociated"]
