from ._annotations import annotate as annotate
from ._birds_eye import birds_eye as birds_eye
from ._drive import RuleBasedDriver as RuleBasedDriver
from ._video import record as record
