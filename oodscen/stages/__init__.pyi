from ._annotations import annotate as annotate
from ._drive import RuleBasedDriver as RuleBasedDriver
from ._video import birds_eye as birds_eye
from ._video import record as record
