from ._annotations import annotate as annotate
from ._annotations import semantic_map as semantic_map
from ._drive import RuleBasedDriver as RuleBasedDriver
from ._options import DescribeOptions as DescribeOptions
from ._options import RedTeamOptions as RedTeamOptions
from ._video import birds_eye as birds_eye
from ._video import record as record
