"""Lets stable-baselines3 learn to stop before a box in the lane, and drives the policy as a stack.

Run it with `python examples/learning_to_stop.py [STEPS]`, after `pip install stable-baselines3 'oodscen[gymnasium]'`.
"""

import sys
from typing import Any

from oodscen import drive, make_simulator
from oodscen.testing import example_scene

ACTIONS = (0, 2)
"""The actions that it chooses from, twice a second: keep the speed, stop."""


def main(steps: str = "4000") -> None:
    """Train a policy for some steps, and compare it with the untrained one in the scene and its twin."""
    try:
        import gymnasium
        import torch
        from stable_baselines3 import PPO
    except ImportError as error:
        print(f"{error}; pip install stable-baselines3 'oodscen[gymnasium]'")
        return
    from oodscen.gymnasium import PolicyDriver

    torch.set_num_threads(1)
    settings: dict[str, Any] = {"actions": "discrete", "step_s": 0.5}
    env = gymnasium.wrappers.TransformAction(
        gymnasium.make("oodscen/Scene-v0", scenes=[example_scene()], twins=True, **settings),
        lambda choice: ACTIONS[choice],
        gymnasium.spaces.Discrete(len(ACTIONS)),
    )
    model = PPO(
        "MultiInputPolicy", env, seed=0, n_steps=250, batch_size=50, gamma=0.95, learning_rate=2e-3
    )

    def policy(seen: Any) -> int:
        return ACTIONS[int(model.predict(seen, deterministic=True)[0])]

    with make_simulator("flat") as simulator:
        for name in ("untrained", "trained"):
            if name == "trained":
                model.learn(int(steps))
            stack = lambda: PolicyDriver(policy, **settings)  # noqa: E731
            for result in drive([example_scene()], stack, simulator, name=name):
                end = f"touches {result.collisions[0]}" if result.collisions else "passes"
                print(f"{result.id:28} {end}, progress {result.progress:.0%}")


if __name__ == "__main__":
    main(*sys.argv[1:2])
