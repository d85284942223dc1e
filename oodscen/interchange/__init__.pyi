from ._writing import ScenarioFile as ScenarioFile
from ._writing import to_openscenario as to_openscenario
