from ._driving import Drive as Drive
from ._driving import Driven as Driven
