"""Campaigns: every model on every scene, in parallel, kept as they come and gone on with after an interruption."""

from .campaign import Campaign, Interrupted, ctrl_c_passed_on, run_campaign, run_tasks
from .tasks import INTERRUPTIONS, Cell, Task

__all__ = ["INTERRUPTIONS", "Campaign", "Cell", "Interrupted", "Task", "ctrl_c_passed_on", "run_campaign", "run_tasks"]
