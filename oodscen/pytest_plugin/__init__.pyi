from ._driving import Drive as Drive
from ._driven import Driven as Driven
