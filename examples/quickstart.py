"""Shows the complete workflow on one page: a tree, one of its texts, a scene, an episode, a picture.

Run it with `python examples/quickstart.py [SIMULATOR]`; it writes `quickstart.png` if OpenCV is
installed.
"""

import sys

from oodscen import (
    Augmenter,
    Describer,
    Pruner,
    RedTeamer,
    TreeGrower,
    make_llm,
    make_simulator,
    simulate,
)
from oodscen.errors import OodscenError


def main(simulator_name: str = "flat") -> None:
    """Walk through the stages and print the result of each."""
    llm = make_llm("builtin", seed=0)
    tree = TreeGrower(llm, nodes=40).run()
    diverse = RedTeamer(llm, iterations=20).run(tree)
    with make_simulator(simulator_name) as simulator:
        catalogue = simulator.catalogue()
        simulatable = Pruner(llm, catalogue).run(diverse)
        print(f"{len(tree)} -> {len(diverse)} -> {len(simulatable)} nodes")
        print(simulatable.outline())
        scenario = Describer(llm, per_path=1).run(simulatable)[0]
        print(f"\n{scenario.text}")
        scene = Augmenter(llm, catalogue).run(scenario)
        result = simulate(scene, simulator)
    for action, outcome in result.episode.actions.items():
        word = "unavailable" if outcome.unavailable else "safe" if outcome.safe else "unsafe"
        print(f"  {action:18} {word}")
    try:
        import cv2
    except ImportError:
        return
    if not cv2.imwrite("quickstart.png", result.frames["last"].rgb[..., ::-1]):
        raise OSError("quickstart.png cannot be written")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:2])
    except (OodscenError, OSError) as error:
        sys.exit(f"quickstart: {error}")
