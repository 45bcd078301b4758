"""Which model a scene needs: models are run in the order of a ladder until the bracket meets the tolerance."""

from .climb import TOLERANCE, Advice, AdviceRung, advise

__all__ = ["TOLERANCE", "Advice", "AdviceRung", "advise"]
