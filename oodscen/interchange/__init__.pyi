from ._ranges import vary as vary
from ._reading.scenario import read_openscenario as read_openscenario
from ._tags import openlabel as openlabel
from ._traces.osi_writing import osi_trace as osi_trace
from ._verdicts.verdict import verdict as verdict
from ._writing.logical import write_logical as write_logical
from ._writing.scenario import to_openscenario as to_openscenario
