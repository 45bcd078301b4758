"""Campaigns: every model on every scene, in parallel; outcomes are saved at once, so interrupted campaigns resume."""

from .campaign import Campaign, Interrupted, ctrl_c_passed_on, run_campaign, run_tasks
from .tasks import INTERRUPTIONS, Cell, Task

__all__ = ["INTERRUPTIONS", "Campaign", "Cell", "Interrupted", "Task", "ctrl_c_passed_on", "run_campaign", "run_tasks"]
