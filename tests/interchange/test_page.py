from oodscen._cli.commands.export import export
from oodscen.driving._motion.behaviours.table import (
    BEHAVIOURS,
    MOVES_BEFORE_TRIGGER,
    WITHOUT_TRIGGER,
)
from oodscen.interchange._reading import actions, positions, triggers
from tests.interchange.page import table


def test_every_element_that_is_read_is_listed_as_read():
    listed = {element for element, _, read in table("elements") if read}
    for module in (actions, positions, triggers):
        assert listed >= module._READERS.keys()


def test_the_formats_are_those_of_the_command():
    (option,) = (param for param in export.params if param.name == "form")
    assert list(option.type.choices) == [row[0] for row in table("formats")]


def test_every_behaviour_is_listed_with_its_form():
    forms = dict(table("behaviours"))
    assert list(forms) == [kind.id for kind in BEHAVIOURS]
    for name, form in forms.items():
        assert ("from the trigger on" in form) == (name not in WITHOUT_TRIGGER), name
        if form.startswith("its recorded course from the trigger on,"):
            assert ("where it then is" in form) == (name in MOVES_BEFORE_TRIGGER), name
