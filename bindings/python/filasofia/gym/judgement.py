"""How a task judges a state."""

import dataclasses


@dataclasses.dataclass
class Judgement:
    """How a state is judged."""

    reward: dict[str, float]  #: terms whose sum is the reward
    success: bool
    measures: dict[str, float]  #: what is measured, in SI units
