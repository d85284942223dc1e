from ._resampling import Interval as Interval
from ._resampling import wilson as wilson
from ._tests import intraclass as intraclass
