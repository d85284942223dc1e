from ._reading.scenario import read_openscenario as read_openscenario
from ._verdicts.verdict import verdict as verdict
