"""The naming prompt: say what a thing that was made to order is, from pictures without its name."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.data._messages import Image
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt


class RecognisedProp(Brief, BaseModel):
    """Answer: what a thing looks like, and the option that names it best."""

    seen: str = Field(default="", max_length=400, description="what it looks like, in a few words")
    choice: int = Field(ge=1, description="number of one option")


class RecogniseProp(Prompt[RecognisedProp]):
    """Name a thing from its pictures, among other things."""

    purpose: ClassVar[str] = "recognise-prop"
    template: ClassVar[str] = "recognise_prop.md"
    answer: ClassVar[type[BaseModel]] = RecognisedProp

    pictures: tuple[Image, ...]
    """The thing by day, from near to far."""
    labels: tuple[str, ...]
    """Things in the order in which they are shown, one of them the right one."""

    def images(self) -> tuple[Image, ...]:
        """Return the pictures."""
        return self.pictures

    def check(self, answer: RecognisedProp) -> list[Issue]:
        """Return a fault if the number is not that of an option."""
        if answer.choice > len(self.labels):
            return [Issue("choice", f"there are {len(self.labels)} options")]
        return []
