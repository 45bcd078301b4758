"""The suite: models, published cases, campaigns, tables, charts and reports."""

from .campaign import Campaign, run_campaign
from .models import MODELS, run_model
from .published import PUBLISHED, published_scene

__all__ = ["MODELS", "PUBLISHED", "Campaign", "published_scene", "run_campaign", "run_model"]
