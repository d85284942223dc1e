from ._ask import ask as ask
from ._remote.limits import Limits as Limits
