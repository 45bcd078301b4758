"""The suite: models, published cases, campaigns, tables, charts and the command line."""

from .campaign import Campaign, Interrupted, run_campaign
from .model import Model
from .models import MODELS, run_model
from .published import PUBLISHED, PublishedCase, published_scene

__all__ = [
    "MODELS",
    "PUBLISHED",
    "Campaign",
    "Interrupted",
    "Model",
    "PublishedCase",
    "published_scene",
    "run_campaign",
    "run_model",
]
