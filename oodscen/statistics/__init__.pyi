from ._answers import intraclass as intraclass
from ._intervals import Interval as Interval
from ._intervals import wilson as wilson
