from ._driven import Driven as Driven
from ._driving import Drive as Drive
