from ._annotations import annotate as annotate
from ._birds_eye import birds_eye as birds_eye
from ._video import record as record
