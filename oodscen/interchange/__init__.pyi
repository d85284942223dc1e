from ._poses import PlayedPoses as PlayedPoses
from ._poses import read_poses as read_poses
from ._recording import twin_of as twin_of
from ._verdict import PlayedVerdict as PlayedVerdict
from ._verdict import verdict as verdict
from ._writing import ScenarioFile as ScenarioFile
from ._writing import to_openscenario as to_openscenario
