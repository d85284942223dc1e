"""The facts of a drive that pictures do not show, and the questions that state them."""

from typing import Any, TypeVar

from pydantic import BaseModel

from oodscen.data._base import Data
from oodscen.data._messages import Image, Message
from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.describe_frame import DescribeFrame, frame_turns

Answer = TypeVar("Answer", bound=BaseModel)


class DriveFacts(Data):
    """The knowledge of a driver who does not look ahead; anything unknown is left out of the questions."""

    times_s: tuple[float, ...] = ()
    """Time of every frame since the start of the drive, s."""
    ego_speed_mps: float | None = None
    shows_decision: bool = True
    """True if the last frame shows the decision, the moment of the speed."""
    behind: str | None = None
    """The vehicle that follows close behind, with its article; empty if there is none, `None` if unknown."""
    gap_m: float = 0.0
    follower_speed_mps: float = 0.0

    @property
    def when(self) -> str:
        """The moment of the speed, in words."""
        return "In the last frame" if self.shows_decision else "At the moment of the decision"


_REAR = (
    "The last picture is not one of the frames: it was taken at the moment of the last frame by a camera that looks "
    "back from the rear window, and is not mirrored."
)

_WITHHELD = (
    "No picture of this drive is available: the frames that are spoken of below are withheld. Give the answer that is "
    "most likely right without them."
)


class DriveQuestion(Prompt[Answer]):
    """A question about the frames of one drive.

    With `descriptions` it follows the model's own descriptions of the frames, as in the paper (section V-C);
    without, it stands alone and shows all frames.
    """

    follows = (DescribeFrame,)

    frames: tuple[Image, ...]
    descriptions: tuple[str, ...] = ()
    """The model's descriptions of the frames."""
    facts: DriveFacts = DriveFacts()
    rear: Image | None = None
    """The view from the rear window at the moment of the last frame; it comes after the frames."""
    withheld: int = 0
    """Number of frames that the question is about and does not show; `frames` is then empty."""

    def variables(self) -> dict[str, Any]:
        """Return the fields; frames that are withheld count in the words."""
        variables = super().variables()
        if self.withheld:
            variables["frames"] = (None,) * self.withheld
        return variables

    def earlier(self) -> tuple[Message, ...]:
        """Return the turns about the frames."""
        return frame_turns(self.frames, self.descriptions)

    def images(self) -> tuple[Image, ...]:
        """Return the frames, unless earlier turns show them, and the view to the rear."""
        frames = () if self.descriptions else self.frames
        return frames if self.rear is None else (*frames, self.rear)

    def question(self) -> str:
        """Render the user's turn; a sentence before it names the view to the rear, or says that no picture is shown."""
        parts = [super().question()]
        if self.withheld:
            parts.insert(0, _WITHHELD)
        if self.rear is not None:
            parts.insert(0, _REAR)
        return "\n\n".join(parts)
