"""Studies of the models themselves: error against cost, and where each method may be trusted."""
