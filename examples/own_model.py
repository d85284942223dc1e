"""Uses a custom language model: one class with a name and one method."""

from oodscen import RedTeamer, TreeGrower, make_llm
from oodscen.protocols import Completion, Request


class Timid:
    """A model that lets the built-in author answer, but never imagines anything with fog."""

    name = "timid"

    def __init__(self) -> None:
        self.author = make_llm("builtin", seed=0)

    def complete(self, request: Request) -> Completion:
        """Answer one request; a client of a server would send `request.messages` here."""
        for sample in range(request.sample, request.sample + 1000, 100):
            answer = self.author.complete(
                Request(request.prompt, request.messages, request.schema, sample)
            )
            if request.prompt.purpose != "imagine-scenario" or "fog" not in answer.text.lower():
                return answer
        return answer


def main() -> None:
    """Grow a tree and red-team it a little."""
    llm = Timid()
    tree = TreeGrower(llm, nodes=30).run()
    for item in RedTeamer(llm, iterations=10).rounds(tree):
        print(f"{item.round:2} {item.decision:8} {item.text}")


if __name__ == "__main__":
    main()
