"""The designing prompt: describe a thing that no catalogue has, as data."""

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field

from oodscen._display import Brief
from oodscen.data._category import Category
from oodscen.data._designs import prop as props
from oodscen.data._designs.colours import PALETTE
from oodscen.data._designs.prop import Prop
from oodscen.data._issues import MOST_PARTS
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt


class DesignedProp(Brief, BaseModel):
    """Answer: the design of a thing, or the reason why there is none."""

    model_config = ConfigDict(extra="forbid")

    reasoning: str = Field(
        default="", description="what makes the thing recognisable, in a sentence"
    )
    prop: Prop | None = Field(description="the design, or null")
    cannot_make: str = Field(
        default="", max_length=400, description="why it cannot be made; else left out"
    )


class KnownPart(Brief, BaseModel):
    """A thing of the catalogue that may be a part."""

    id: str
    length_m: float
    width_m: float
    height_m: float


class DesignProp(Prompt[DesignedProp]):
    """Make what a catalogue lacks."""

    purpose: ClassVar[str] = "design-prop"
    template: ClassVar[str] = "design_prop.md"
    answer: ClassVar[type[BaseModel]] = DesignedProp

    name: str
    """Name of the thing, which becomes its id."""
    category: Category = "object"
    path: tuple[str, ...] = ()
    """Labels from the root down to a leaf that needs it."""
    known: tuple[KnownPart, ...] = ()
    """Things of the catalogue that may be parts."""

    def variables(self) -> dict[str, Any]:
        """Return the fields, with the limits of a design and the colours that have a name."""
        return {
            **super().variables(),
            "limits": {
                "parts": MOST_PARTS,
                "solids": props.MOST_SOLIDS,
                "triangles": props.MOST_TRIANGLES,
                "size": props.LARGEST,
                "light_kg": props.LIGHT_KG,
                "clear_m": props.CLEAR_M,
            },
            "palette": tuple(PALETTE),
        }

    def check(self, answer: DesignedProp) -> list[Issue]:
        """Return faults: no design and no reason, or another name or category than asked for."""
        if answer.prop is None:
            if answer.cannot_make:
                return []
            return [Issue("prop", "give the design, or say in `cannot_make` why there is none")]
        issues = []
        if answer.prop.id != self.name:
            issues.append(Issue("prop.id", f"must be {self.name!r}"))
        if answer.prop.category != self.category:
            issues.append(Issue("prop.category", f"must be {self.category!r}"))
        return issues
