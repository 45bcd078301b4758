"""Which model a scene needs: the ladder of models, climbed until the answer is as narrow as asked."""

from .climb import TOLERANCE, Advice, AdviceRung, advise

__all__ = ["TOLERANCE", "Advice", "AdviceRung", "advise"]
